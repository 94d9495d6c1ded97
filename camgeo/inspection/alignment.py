"""How measured points lie on the exact flank: as measured from the datum, or fitted.

A measured point is P = S + exp(i alpha) Q, with Q its place in cam coordinates, S the shift and
alpha the turn of the part, counter-clockwise positive. A fit minimizes the sum of the squares of
the distances e of all Q from the flank. With the exact normal n at the foot of Q a step (dS,
dalpha) of the part changes e by

    de = -n . dS - (n . iQ) dalpha

to the first order, for the foot itself moves along the flank: that is the Jacobian of Gauss and
Newton's method, in closed form, and (A^T A)^-1 sigma^2 the covariance of shift and turn. n . iQ is
the lever of the normal about the cam axis; where the flank is a circle about any point it is a
linear combination of the components of n, and the turn is undetermined.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.inspection.exact_flank import ExactFlank, Feet
from camgeo.inspection.robust import standard_error, weights
from camgeo.numeric import student
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot

CONFIDENCE: Final = 0.95
"""Of each uncertainty, by itself."""

FEWEST: Final = student.FEWEST + 3
"""Points of a fit."""

STEPS: Final = 40
"""Most steps of a fit; from a start as near as these, six are many."""

SETTLED: Final = 1e-12
"""A step below this fraction of the flank's size is the last one."""

ROBUST: Final = 1e-10
PATIENT: Final = 200
"""The same, and the most steps, of a robust fit, whose weights change from step to step."""

NEAR: Final = 1e-5
TRIAL: Final = 15
"""The same, and the most steps, while starts are compared."""

SLACK: Final = 1000.0
"""A fit whose last step exceeds the above by this factor has no result."""

LOST: Final = 1e-9
"""A direction in which no point moves off the flank by more than this fraction of the step is
undetermined."""

STARTS: Final = 720
"""Turns that are tried for the start of a fit, evenly round."""

TRIED: Final = 6
"""The best of them that are followed."""

PROMISING: Final = 3.0
"""Those that miss by more than the best one by this factor are not."""

SOME: Final = 400
"""Points that decide between starts."""

ALIKE: Final = 1.5
"""Two fits whose distances differ by less than this factor are equally good."""

FLOOR: Final = 1e-12
"""Distances below this fraction of the flank's size are rounding."""

APART: Final = math.radians(1.0)
"""Fits that differ by less than this turn are one."""


class Align(StrEnum):
    """What is fitted: nothing, the turn about the cam axis, or shift and turn."""

    DATUM = "datum"
    ROTATION = "rotation"
    FREE = "free"

    @property
    def fitted(self) -> int:
        """Number of fitted figures."""
        return {Align.DATUM: 0, Align.ROTATION: 1, Align.FREE: 3}[self]


@dataclass(frozen=True, slots=True)
class Frame:
    """Where the part lies in the axes of the measurement.

    Attributes
    ----------
    shift : S [mm].
    turn : alpha [rad], counter-clockwise positive, in (-pi, pi].
    """

    shift: complex = 0j
    turn: float = 0.0

    def inward(self, points: ComplexArray) -> ComplexArray:
        """(n,) places in cam coordinates of measured `points` (n,)."""
        found: ComplexArray = (points - self.shift) * cmath.exp(-1j * self.turn)
        return found

    def moved(self, shift: complex, turn: float) -> Frame:
        """The frame after a step of the part in cam coordinates, first the shift, then the turn."""
        return Frame(
            self.shift + cmath.exp(1j * self.turn) * shift,
            -math.remainder(-self.turn - turn, 2.0 * math.pi),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """Measured points on the flank.

    Attributes
    ----------
    align : what is fitted.
    frame : of the part.
    feet : of the points in cam coordinates.
    deviations : (n,) [mm] distances from the flank less the radius of the ball, positive where
        there is more material.
    shift_uncertainty : of both coordinates of the shift [mm], at `CONFIDENCE`; None if not fitted.
    turn_uncertainty : of the turn [rad]; infinite if the points do not show it, None if not fitted.
    sway : what errors of form can do to a fit of least squares: the largest shift [mm] and turn
        [rad] that any deviations of 1 mm root mean square cause. Zeros for what is not fitted.
    other_turn : a further turn [rad] at which the points fit as well, as on a flank that repeats
        itself; None if there is none.
    """

    align: Align
    frame: Frame
    feet: Feet
    deviations: FloatArray
    shift_uncertainty: tuple[float, float] | None = None
    turn_uncertainty: float | None = None
    sway: tuple[float, float] = (0.0, 0.0)
    other_turn: float | None = None


def aligned(
    flank: ExactFlank,
    points: ComplexArray,
    align: Align,
    ball: float = 0.0,
    *,
    robust: bool = False,
) -> Alignment:
    """Lay measured `points` (n,) [mm] on the flank.

    Parameters
    ----------
    ball : radius [mm] of the ball whose centres the points are; 0 for points of the flank.
    robust : whether a fit passes over local errors of form, see `camgeo.inspection.robust`.

    Raises
    ------
    GeometryError
        If there are too few points for a fit, it does not settle, or the points do not show the
        shift.
    """
    if align is Align.DATUM:
        return _result(flank, points, align, Frame(), ball)
    if len(points) < FEWEST:
        raise GeometryError(
            f"a fit needs {FEWEST} points or more, and there are {len(points)}; align by datum"
        )
    frame, other = _best(flank, points, align, ball)
    frame = _fit(flank, points, align, frame, ball)
    if robust:
        frame = _fit(flank, points, align, frame, ball, ROBUST, PATIENT, robust=True)
    found = _result(flank, points, align, frame, ball)
    shift, turn, sway = _uncertainties(found, flank.size, robust=robust)
    other = None if math.isinf(turn) else other
    return replace(
        found, shift_uncertainty=shift, turn_uncertainty=turn, sway=sway, other_turn=other
    )


def _result(
    flank: ExactFlank, points: ComplexArray, align: Align, frame: Frame, ball: float
) -> Alignment:
    feet = flank.feet(frame.inward(points))
    return Alignment(align, frame, feet, feet.distances - ball)


def _best(
    flank: ExactFlank, points: ComplexArray, align: Align, ball: float
) -> tuple[Frame, float | None]:
    """A frame near the best one, and another turn that is as good."""
    some = points[:: -(-len(points) // SOME)]
    fits: list[tuple[float, Frame]] = []
    for start in _starts(flank, some, align):
        try:
            frame = _fit(flank, some, align, start, ball, NEAR, TRIAL)
        except GeometryError:
            continue
        distances = flank.feet(frame.inward(some)).distances - ball
        fits.append((float(np.sqrt(np.mean(distances**2))), frame))
    if not fits:
        raise GeometryError("the points are no flank of this disc: no fit of them settles")
    least = ALIKE * min(size for size, _ in fits) + FLOOR * flank.size
    good = [frame for size, frame in fits if size <= least]
    best = min(good, key=lambda frame: abs(frame.turn))
    others = [
        frame.turn
        for frame in good
        if abs(math.remainder(frame.turn - best.turn, 2.0 * math.pi)) > APART
    ]
    return best, min(others, key=abs, default=None)


def _starts(flank: ExactFlank, points: ComplexArray, align: Align) -> list[Frame]:
    """Frames from which a fit may find its way: the distances from the cam axis, over the polar
    angle, are compared at many turns. For a shift the axis is first found by the centres of area.
    """
    nodes = flank.nodes.points
    order = np.argsort(np.angle(nodes))
    polar, radii = np.angle(nodes)[order], np.abs(nodes)[order]

    def misses(inward: ComplexArray) -> FloatArray:
        nominal = np.interp(np.angle(inward), polar, radii, period=2.0 * math.pi)
        return np.asarray(np.sqrt(np.mean((np.abs(inward) - nominal) ** 2, axis=-1)))

    centre, own = 0j, 0j
    if align is Align.FREE:
        centre, own = _centre(points), _centre(nodes)
    turns = np.linspace(-math.pi, math.pi, STARTS, endpoint=False)
    found = misses((points - centre) * np.exp(-1j * turns)[:, np.newaxis] + own)
    lowest = np.flatnonzero((found <= np.roll(found, 1)) & (found <= np.roll(found, -1)))
    lowest = lowest[np.argsort(found[lowest], kind="stable")][:TRIED]
    # A turn between two that are tried misses by half their distance.
    unsure = PROMISING * float(found[lowest[0]]) + math.pi / STARTS * flank.size
    starts = [Frame(centre - own * cmath.exp(1j * turn), turn) for turn in turns[lowest].tolist()]
    promising = [each for each, miss in zip(starts, found[lowest], strict=True) if miss <= unsure]
    return [Frame()] * bool(misses(points) <= unsure) + promising


def _centre(points: ComplexArray) -> complex:
    """Centre of the area inside `points` (n,), joined by their polar angle about their mean."""
    mean = complex(np.mean(points))
    ring = points - mean
    ring = ring[np.argsort(np.angle(ring))]
    after = np.roll(ring, -1)
    areas = (ring.conj() * after).imag
    total = float(np.sum(areas))
    return mean if total <= 0.0 else mean + complex(np.sum((ring + after) * areas)) / total / 3.0


def _jacobian(feet: Feet, size: float) -> FloatArray:
    """(n, 3) -de for steps of the shift [mm] and of the turn [rad] times `size`."""
    normals = feet.places.normals
    places = feet.places.points + feet.distances * normals
    return np.column_stack((normals.real, normals.imag, dot(normals, 1j * places) / size))


def _fit(
    flank: ExactFlank,
    points: ComplexArray,
    align: Align,
    frame: Frame,
    ball: float,
    settled: float = SETTLED,
    steps: int = STEPS,
    *,
    robust: bool = False,
) -> Frame:
    """The frame of the least squares near `frame`; of weighted ones if `robust`."""
    last = math.inf
    for _ in range(steps):
        feet = flank.feet(frame.inward(points))
        matrix = _jacobian(feet, flank.size)
        columns = _determined(matrix, align)
        step = np.zeros(3)
        misses = feet.distances - ball
        if robust:
            roots = np.sqrt(weights(misses, FLOOR * flank.size))
            matrix, misses = matrix * roots[:, np.newaxis], misses * roots
        step[columns] = np.linalg.lstsq(matrix[:, columns], misses, rcond=None)[0]
        step /= flank.size
        frame = frame.moved(complex(step[0], step[1]) * flank.size, float(step[2]))
        last = float(np.max(np.abs(step)))
        if last <= settled or last > 1.0:
            break
    if last > SLACK * settled:
        raise GeometryError("the points are no flank of this disc: the fit does not settle")
    return frame


def _determined(matrix: FloatArray, align: Align) -> list[int]:
    """The columns (n, 3) of what is fitted and what the points show.

    Raises GeometryError if they do not show the shift.
    """
    count = math.sqrt(len(matrix))
    if align is Align.FREE:
        if np.linalg.svd(matrix[:, :2], compute_uv=False)[1] <= LOST * count:
            raise GeometryError(
                "the points do not show the shift of the part: their normals are all parallel;"
                " measure all round, or align by datum"
            )
        known, _ = np.linalg.qr(matrix[:, :2])
        lever = matrix[:, 2] - known @ (known.T @ matrix[:, 2])
    else:
        lever = matrix[:, 2]
    shows = float(np.linalg.norm(lever)) > LOST * count
    return [0, 1] * (align is Align.FREE) + [2] * shows


def _uncertainties(
    found: Alignment, size: float, *, robust: bool = False
) -> tuple[tuple[float, float] | None, float, tuple[float, float]]:
    """Of shift [mm] and turn [rad], at `CONFIDENCE`: by Student's t from the covariance; and the
    sway.
    """
    count = len(found.deviations)
    matrix = _jacobian(found.feet, size)
    columns = _determined(matrix, found.align)
    freedom = count - found.align.fitted
    sigma = math.sqrt(float(np.sum(found.deviations**2)) / freedom)
    if robust:
        sigma = standard_error(found.deviations, freedom, FLOOR * size)
    factor = sigma * student.quantile(0.5 + 0.5 * CONFIDENCE, freedom)
    chosen = matrix[:, columns]
    cofactors = np.zeros((3, 3))
    if columns:
        cofactors[np.ix_(columns, columns)] = np.linalg.inv(chosen.T @ chosen)
    of_turn = math.sqrt(cofactors[2, 2]) / size
    turn = factor * of_turn if 2 in columns else math.inf
    # The shift is that of the cam axis in the axes of the measurement, which are turned.
    cosine, sine = math.cos(found.frame.turn), math.sin(found.frame.turn)
    across = np.array([[cosine, -sine], [sine, cosine]])
    covariance = across @ cofactors[:2, :2] @ across.T
    x, y = (factor * math.sqrt(covariance[k, k]) for k in (0, 1))
    # By Cauchy and Schwarz: the fit is linear in the deviations, and this is the norm of its rows.
    of_shift = math.sqrt(float(np.linalg.norm(cofactors[:2, :2], 2)))
    sway = (math.sqrt(count) * of_shift, math.sqrt(count) * of_turn)
    return ((x, y) if found.align is Align.FREE else None), turn, sway
