"""Splines through points and near them: quintic, with the least integral of s''' squared.

All of them minimise one energy over the values (y, s', s'') at the given points,

    sum over the points of (s(x_i) - y_i)^2  +  lambda * integral of s'''(x)^2 dx,

with some of the nodal values prescribed; an interpolating spline has all y prescribed, so the sum
is zero and lambda has no effect. Between two points the minimiser is the quintic with these nodal
values. At a point where s' is free s'''' is continuous, where s'' is free s''' is continuous: those
are the energy's natural conditions (the factors of a variation of s' and s''). So

- where nothing is prescribed, s is continuous up to the fourth derivative (C4);
- where only s' is prescribed, s to s''' are continuous and s'''' may jump;
- where only s'' is prescribed, s to s'' and s'''' are continuous and s''' may jump;
- where both are, s to s'' are continuous, s''' and s'''' may jump;
- at an end, the natural conditions are s''' = 0 (s'' free) and s'''' = 0 (s' free).

C. de Boor, A Practical Guide to Splines, ch. XIV (smoothing); C. H. Reinsch, Numer. Math. 10 (1967)
177-183, for the second derivative instead of the third.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE, Boundary, boundaries_of, boundary_of
from camgeo.motion.spline import Spline
from camgeo.motion.spline_energy import HIGHEST, Smoothing, from_stress, hermite, interpolate
from camgeo.numeric import checked
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.wording import counted

MOST_UNEQUAL: Final = 1e6
"""Largest allowed ratio of the longest to the shortest distance of neighbouring points. The solve
keeps eight digits there, but the rounding of the points' own values weighs ever more in the slope
between close ones."""

MIN_RING: Final = 3
"""Points of the smallest ring that can be solved."""


@dataclass(frozen=True, slots=True)
class FitReport:
    """Deviation of a spline from all points of its data.

    Attributes
    ----------
    largest_deviation : largest |s(x_i) - y_i|, in the unit of y.
    rms : root of the mean square of s(x_i) - y_i, in the unit of y.
    place : the x_i of the largest deviation.
    length : cut-off length of the smoothing, in the unit of x; 0 if the spline interpolates.
    """

    largest_deviation: float
    rms: float
    place: float
    length: float = 0.0


# Builders -------------------------------------------------------------------------------------


def periodic_spline(
    x: FloatArray, y: FloatArray, period: float, rise: float = 0.0, gap: float = 0.0
) -> Spline:
    """Interpolate with s(x + period) = s(x) + rise; C4 everywhere, the seam included.

    Parameters
    ----------
    x : (n,) ascending, n >= 3 without the closing point x[0] + period, which may be missing.
    y : (n,) the values there.
    period : in the unit of x, larger than x[-1] - x[0], or equal with a closing point.
    rise : growth over a period, in the unit of y.
    gap : allowed distance of a closing point from y[0] + rise; it has no other use.

    Raises
    ------
    GeometryError
        For too few points, points that do not ascend or are spaced too unequally, numbers that are
        not finite, points beyond the period, and a closing point that does not close.
    """
    x, y = _ring(*_checked(x, y), period, rise, gap)
    step = np.diff(np.append(x, x[0] + period))
    _check_spacing(step)
    nodes, fixed = _prescribed(y, {})
    fixed[:, 0] = True
    chord = np.diff(np.append(y, y[0] + rise))
    nodes = interpolate(step, chord, nodes, fixed, ring=True)
    ends = np.roll(nodes, -1, axis=0)
    return Spline(np.append(x, x[0] + period), hermite(step, chord, nodes, ends), True, float(rise))


def clamped_spline(
    x: FloatArray,
    y: FloatArray,
    start: Boundary = FREE,
    end: Boundary = FREE,
    inner: Mapping[int, Boundary] | None = None,
) -> Spline:
    """Interpolate with prescribed s' and s'' at the ends and at any inner points.

    The module docstring states which derivatives are continuous where. With both values given at
    both ends and none inside, a polynomial of degree 5 is reproduced.

    Parameters
    ----------
    x, y : (n,) ascending x, n >= 2, and the values there; n = 2 needs a prescribed s' or s''.
    start, end : (s', s'') at the first and the last point, None where free.
    inner : the same for further points, by index 1 to n - 2.

    Raises
    ------
    GeometryError
        For too few points, points that do not ascend or are spaced too unequally, numbers that are
        not finite, and an index that is not that of an inner point.
    """
    x, y = _checked(x, y)
    nodes, fixed = _prescribed(y, _boundaries(len(x), start, end, {} if inner is None else inner))
    fixed[:, 0] = True
    if len(x) == 2 and np.count_nonzero(fixed) == 2:
        raise GeometryError(
            "2 points without a velocity or acceleration are too few; 3 are allowed", key="x"
        )
    step, chord = np.diff(x), np.diff(y)
    nodes = interpolate(step, chord, nodes, fixed, ring=False)
    return Spline(x, hermite(step, chord, nodes[:-1], nodes[1:]))


def smooth_periodic_spline(
    x: FloatArray,
    y: FloatArray,
    period: float,
    largest_deviation: float,
    gap: float = 0.0,
) -> tuple[Spline, FitReport]:
    """Smooth with s(x + period) = s(x); C4 everywhere, the seam included.

    Parameters
    ----------
    x, y, period, gap : as for `periodic_spline`.
    largest_deviation : allowed |s(x_i) - y_i|, in the unit of y, > 0. The cut-off length is the
        longest found whose spline keeps it. Of all splines that keep it, others can have a
        smaller integral of s''' squared: this one also keeps the sum of squares small.

    Returns
    -------
    The spline, and its deviation from all points except a closing one.

    Raises
    ------
    GeometryError
        As for `periodic_spline`; and if no spline keeps the deviation.
    """
    x, y = _ring(*_checked(x, y), period, 0.0, gap)
    knots = np.append(x, x[0] + period)
    _check_spacing(np.diff(knots))
    return _smoothed(x, knots, *_prescribed(y, {}), largest_deviation, ring=True)


def smooth_clamped_spline(
    x: FloatArray,
    y: FloatArray,
    start: Boundary = FREE,
    end: Boundary = FREE,
    *,
    largest_deviation: float,
) -> tuple[Spline, FitReport]:
    """Smooth between the first and the last point, which are kept with their s' and s''.

    Parameters and errors as for `clamped_spline` and `smooth_periodic_spline`; n >= 3.
    C4 inside; for the ends see the module docstring.
    """
    x, y = _checked(x, y)
    if len(x) < 3:
        raise GeometryError(f"{_few(x)} to smooth; at least 3 are allowed", "x")
    nodes, fixed = _prescribed(y, _boundaries(len(x), start, end, {}))
    fixed[[0, -1], 0] = True
    return _smoothed(x, x, nodes, fixed, largest_deviation, ring=False)


def _smoothed(
    x: FloatArray,
    knots: FloatArray,
    nodes: FloatArray,
    fixed: BoolArray,
    largest_deviation: float,
    *,
    ring: bool,
) -> tuple[Spline, FitReport]:
    step = np.diff(knots)
    found, stress, length = Smoothing(step, nodes, fixed, ring).within(largest_deviation)
    spline = Spline(knots, from_stress(step, found[: len(step)], stress), ring)
    return spline, _report(x, found[:, 0] - nodes[:, 0], length)


def smoothest_values(
    x: FloatArray, y: FloatArray, given: Mapping[int, Boundary], period: float | None = None
) -> FloatArray:
    """(n, 2) s' and s'' at each point of the interpolant with these values prescribed.

    Parameters
    ----------
    x, y : (n,) ascending x and the values there; n >= 2, or 1 with a period.
    given : prescribed s' and s'' by index of the point, None where free.
    period : of a motion that closes, larger than x[-1] - x[0]; None for one that ends.

    Raises GeometryError as `clamped_spline` does.
    """
    count = len(x)
    if period is not None:
        # A ring of few points is repeated: the matrix needs distinct neighbours.
        times = -(-MIN_RING // count)
        x = np.concatenate([x + k * period for k in range(times)])
        y = np.tile(y, times)
        given = {k * count + index: value for index, value in given.items() for k in range(times)}
        x, y = _checked(x, y)
        step, chord = np.diff(np.append(x, x[0] + times * period)), np.diff(np.append(y, y[0]))
        _check_spacing(step)
    else:
        x, y = _checked(x, y)
        step, chord = np.diff(x), np.diff(y)
    nodes, fixed = _prescribed(y, given)
    fixed[:, 0] = True
    ring = period is not None
    slopes: FloatArray = interpolate(step, chord, nodes, fixed, ring=ring)[:count, 1:]
    return slopes


def report(spline: Spline, x: FloatArray, y: FloatArray, length: float = 0.0) -> FitReport:
    """Deviation of `spline` from the points `x`, `y` (n,), at all of them."""
    return _report(x, spline.values(x, 0)[0] - y, length)


def _report(x: FloatArray, deviation: FloatArray, length: float) -> FitReport:
    worst = int(np.argmax(np.abs(deviation)))
    return FitReport(
        float(abs(deviation[worst])),
        float(np.sqrt(np.mean(deviation**2))),
        float(x[worst]),
        length,
    )


# Checks ---------------------------------------------------------------------------------------


def _checked(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    x, y = checked.array("x", x), checked.array("y", y, largest=HIGHEST)
    if x.shape != y.shape:
        raise GeometryError(
            f"has {counted(len(y), 'number')}, x has {len(x)}; allowed: as many as x", "y"
        )
    if len(x) < 2:
        raise GeometryError(f"{_few(x)}; at least 2 are allowed", "x")
    step = np.diff(x)
    wrong = np.flatnonzero(step <= 0.0)
    if len(wrong):
        place = int(wrong[0])
        fault = "equal" if step[place] == 0.0 else "descending"
        raise GeometryError(
            f"the x of points {place + 1} and {place + 2} are {fault} ({float(x[place])!r},"
            f" {float(x[place + 1])!r});"
            " allowed: only ascending",
            key="x",
            value=repr(float(x[place + 1])),
        )
    checked.positive("x", x[-1] - x[0])
    _check_spacing(step)
    return x, y


def _check_spacing(step: FloatArray) -> None:
    found = float(np.max(step)) / float(np.min(step))
    if not found <= MOST_UNEQUAL * (1.0 + 1e-6):
        place = int(np.argmin(step))
        raise GeometryError(
            f"the points are spaced too unequally: the longest distance is {found:.3g} times the"
            f" shortest, which follows point {place + 1}; allowed: up to {MOST_UNEQUAL:g}",
            key="x",
            value=repr(found),
        )


def _ring(
    x: FloatArray, y: FloatArray, period: float, rise: float, gap: float
) -> tuple[FloatArray, FloatArray]:
    """The points of one period without the closing one."""
    period = checked.positive("period", period)
    rise = checked.number("rise", rise, largest=HIGHEST)
    gap = checked.number("gap", gap, least=0.0, largest=HIGHEST)
    rest = float(x[0]) + period - float(x[-1])
    rounding = 4.0 * np.spacing(max(abs(float(x[0])), abs(float(x[-1])), period))
    if rest < -rounding:
        raise GeometryError(
            f"the points span {float(x[-1] - x[0])!r}; allowed: up to the period {period!r}",
            key="period",
            value=repr(float(x[-1] - x[0])),
        )
    if rest <= rounding:
        seam = float(y[-1]) - (float(y[0]) + rise)
        if not abs(seam) <= gap:
            raise GeometryError(
                f"the last point lies {seam:g} off where it would close with the first; allowed:"
                f" up to {gap:g}",
                key="y",
                value=repr(seam),
            )
        x, y = x[:-1], y[:-1]
    if len(x) < 3:
        raise GeometryError(
            f"{_few(x)} for a period, without the closing one; at least 3 are allowed", "x"
        )
    return x, y


def _few(x: FloatArray) -> str:
    return f"{counted(len(x), 'point')} {'is' if len(x) == 1 else 'are'} too few"


def _boundaries(
    count: int, start: Boundary, end: Boundary, inner: Mapping[int, Boundary]
) -> dict[int, Boundary]:
    """The prescribed values, by index of the point."""
    return {
        0: boundary_of("start", start),
        **boundaries_of("inner", inner, 1, count - 2),
        count - 1: boundary_of("end", end),
    }


def _prescribed(y: FloatArray, given: Mapping[int, Boundary]) -> tuple[FloatArray, BoolArray]:
    """(n, 3) nodal values y, s', s'', and which of s', s'' are prescribed."""
    nodes = np.zeros((len(y), 3))
    fixed = np.zeros((len(y), 3), dtype=np.bool_)
    nodes[:, 0] = y
    for index, values in given.items():
        for column, value in enumerate(values, start=1):
            if value is not None:
                nodes[index, column], fixed[index, column] = value, True
    return nodes, fixed
