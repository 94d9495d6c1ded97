"""Fit by cubic splines: C2 along each smooth piece, tangent at breaks, dwells and turns as arcs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from camgeo.contour.cubics.arc_length import ArcLength, require_finite
from camgeo.contour.cubics.deviation import fitted_deviation
from camgeo.contour.cubics.least_squares import Ends
from camgeo.contour.cubics.parts import ROUNDING, Part, parts_of
from camgeo.contour.cubics.search import Found, fast, fewest
from camgeo.contour.legs import legs_of
from camgeo.contour.proof.deviation import SHARPNESS
from camgeo.contour.proved import proved
from camgeo.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.errors import ToleranceError
from camgeo.outline.path import Path

AIM = 0.96
"""Fraction of the tolerance that the distance found may reach. The proof takes 1 % for its cells
and 2 % for its arcs, which may lie farther off than the spline; the rest is for what the parabolas
between samples miss, so that the first proof holds."""

STRAIGHT = 2.0**-52 * 64.0
"""A piece whose sagitta is a smaller fraction of its distance from the cam axis is a line."""

Search = Callable[[ArcLength, Ends, float, float], list[Found]]


def fit_spline(path: Path, tolerance: float) -> SplineFit:
    """Cubic splines within `tolerance` [mm] of `path`, counter-clockwise, in one pass.

    Each smooth piece between breaks is one spline, C2 inside and along the curve's tangents at both
    ends. Each dwell is one arc about the cam axis, of any sweep, each arc of the path is one arc,
    and a straight piece is one line. Corners are where the path has them and nowhere else.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path, or the path has a gap.
    """
    return _proved(path, tolerance, fast)


def fewest_cubics(path: Path, tolerance: float) -> SplineFit:
    """As `fit_spline`, with the fewest cubics along each smooth piece, then the least deviation.

    Only splines over the arc length are searched; for their number see
    `camgeo.contour.cubics.search.CUBIC_CONSTANT`.
    """
    return _proved(path, tolerance, fewest)


def _proved(path: Path, tolerance: float, search: Search) -> SplineFit:
    legs = legs_of(path)
    parts = parts_of(legs, tolerance)
    size = max(abs(part.start) for part in parts)
    if not tolerance > ROUNDING * size:
        raise ToleranceError("a spline cannot follow the curve", tolerance, ROUNDING * size)
    ends = [part.start for part in (*parts[1:], parts[0])]
    arcs = [part.arc(end) for part, end in zip(parts, ends, strict=True)]
    groups = _groups(parts, ends, [k for k, arc in enumerate(arcs) if arc is None])

    def fit(aim: float) -> tuple[SplineContour, float]:
        whole: list[CubicSpline | Arc | None] = list(arcs)
        error = 0.0
        for chosen, course, ends_of in groups:
            for k, found in zip(chosen, search(course, ends_of, aim, tolerance), strict=True):
                whole[k] = _strand(found.spline, size)
                error = max(error, found.error)
        return SplineContour(tuple(strand for strand in whole if strand is not None)), error

    def prove(made: tuple[SplineContour, float]) -> float:
        return fitted_deviation(legs, parts, *made, SHARPNESS * tolerance)

    (contour, _), reached = proved(fit, prove, AIM * tolerance, tolerance)
    return SplineFit(contour.counter_clockwise(), reached, tolerance)


def _groups(
    parts: Sequence[Part], ends: Sequence[complex], open_parts: Sequence[int]
) -> list[tuple[list[int], ArcLength, Ends]]:
    """The parts that need splines, by their curve; nearly always there is only one."""
    chosen: dict[int, tuple[ArcLength, list[int]]] = {}
    for k in open_parts:
        course = parts[k].course
        if course is not None:
            chosen.setdefault(id(course), (course, []))[1].append(k)
    found = []
    for course, members in chosen.values():
        require_finite(course)
        ends_of = Ends(
            np.array([parts[k].start for k in members]),
            np.array([ends[k] for k in members]),
            np.array([parts[k].first for k in members]),
            np.array([parts[k].last for k in members]),
        )
        found.append((members, course, ends_of))
    return found


def _strand(spline: CubicSpline, size: float) -> CubicSpline | Arc:
    """The spline, or a line if it is straight."""
    chord = spline.end - spline.start
    across = np.conj(chord) * (spline.controls - spline.start)
    if len(spline) == 1 and np.max(np.abs(across.imag)) <= STRAIGHT * size * abs(chord):
        return Arc(spline.start, spline.end, 0.0, 0j)
    return spline
