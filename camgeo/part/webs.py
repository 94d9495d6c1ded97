"""The thinnest material between two boundaries of a part."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import distances, least_distance
from camgeo.contour.pieces import Pieces
from camgeo.contour.simple import winding_number
from camgeo.inspection.exact_flank import ExactFlank
from camgeo.outline.path import Flank
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.engraving import text_of
from camgeo.part.part import Boundary, Layer, Part

TOLERANCES: Final = (1e-2, 1e-4, 1e-6)
"""Of the contours of flanks [mm], each tried if the one before leaves a comparison open."""

SHARE: Final = 0.1
"""Least thickness of a web as a share of the diameter of the larger hole beside it: a ring of that
wall bears at its bore, by Lame's equations, 5.5 times the pressure there as hoop stress.
"""

POINTS: Final = 400
"""Along a hole, by which the place of a web is found."""

STEP: Final = 0.1
"""Turn of the arcs [rad] by whose ends circles about holes are found."""


Size = Callable[[float, float], float]
"""By which webs are compared, of thickness and usual thickness [mm]."""


@dataclass(frozen=True, slots=True)
class Web:
    """Material between two boundaries.

    Attributes
    ----------
    one, other : their names, the other one that of a hole.
    thickness : the smallest distance between them [mm], exact of lines and arcs, beside a circle
        about the cam axis, and where a circle or corner of a hole is nearest to a flank; else
        within the second of `TOLERANCES`, or the last if that decides how it compares.
    usual : thickness that it should have [mm], by `SHARE`; 0 beside flanks alone, whose loads
        decide it.
    place : of the hole, where it is thinnest [mm], for the eye.
    """

    one: str
    other: str
    thickness: float
    usual: float
    place: complex


def thinnest(part: Part, limit: float | None = None) -> Web | None:
    """The web of the smallest thickness, as exact as its comparison with a `limit` [mm] takes, or
    without one with its usual thickness. None if the part has no holes.

    Raises
    ------
    UndercutError, ToleranceError
        If a boundary has no contour.
    """
    return thinnest_of_each(part, limit)[0]


def thinnest_of_each(part: Part, limit: float | None = None) -> tuple[Web | None, Web | None]:
    """That of `thinnest`, and without a limit the web that is thinnest as a share of its usual
    thickness, None if no web has one; raises like `thinnest`.
    """
    sizes = (_thickness, _share) if limit is None else (_thickness,)
    found: dict[Size, tuple[float, float, Web]] = {}
    for one, hole in _pairs(part):
        usual, least = _usual(one, hole), _least(one, hole)
        beaten = [each for each in sizes if each in found and each(least, usual) > found[each][0]]
        if len(beaten) == len(sizes) or not _material_between(one, hole):
            continue
        web = _web(one, hole, usual, usual if limit is None else limit)
        for each in sizes:
            new = each(web.thickness, usual), web.thickness, web
            if each not in found or new[:2] < found[each][:2]:
                found[each] = new
    first, beside = (found[each][2] if each in found else None for each in (_thickness, _share))
    return first, beside if beside is not None and beside.usual else None


def surely_thick(part: Part, limit: float | None = None) -> bool:
    """Whether circles about the boundaries suffice to show that no web is thinner than the `limit`
    [mm], or where that is None than its usual thickness; raises like `thinnest`.
    """
    return all(
        _least(one, hole) >= (_usual(one, hole) if limit is None else limit)
        for one, hole in _pairs(part)
    )


def _thickness(thickness: float, _: float) -> float:
    return thickness


def _share(thickness: float, usual: float) -> float:
    return thickness / usual if usual else math.inf


def _pairs(part: Part) -> Iterator[tuple[Boundary, Boundary]]:
    """Boundaries of a layer of which the second at least is a hole, each pair of names once."""
    known: set[tuple[str, str]] = set()
    for layer in part.layers:
        for pair in combinations(_walled(layer), 2):
            one, hole = pair if pair[1].hole else pair[::-1]
            names = one.name, hole.name
            if hole.hole and names not in known:
                known.add(names)
                yield one, hole


def _walled(layer: Layer) -> list[Boundary]:
    """Its boundaries but for those of letters: what is left beside their strokes bears nothing."""
    return [each for each in layer.boundaries if not text_of(each.name)]


def _least(one: Boundary, hole: Boundary) -> float:
    """A lower bound of the thickness of a web [mm], from circles about two holes, or about the cam
    axis within an outline and around a hole.
    """
    if not one.hole:
        return max(0.0, one.nearest() - hole.farthest()[0])
    circles = []
    for each in (one, hole):
        fit = each.beside(TOLERANCES[0])
        fine = fit.contour.split(STEP)
        middle = complex(np.mean(fine.vertices))
        sagitta = float(np.max(fine.radii)) * (1.0 - math.cos(0.5 * STEP))
        reach = float(np.max(np.abs(fine.vertices - middle))) + sagitta
        circles.append((middle, reach))
    (a, of_a), (b, of_b) = circles
    return max(0.0, abs(a - b) - of_a - of_b)


def _material_between(one: Boundary, hole: Boundary) -> bool:
    """Whether there is material between two boundaries of a section but for other boundaries."""
    a, b = (each.beside(TOLERANCES[0]).contour for each in (one, hole))
    if one.hole:
        return not (_inside(a, b) or _inside(b, a))
    return _inside(b, a)


def _inside(contour: Contour, around: Contour) -> bool:
    return winding_number(around, complex(contour.vertices[0])) != 0


def _web(one: Boundary, hole: Boundary, usual: float, compared: float) -> Web:
    exact = None if one.hole else _about_the_axis(one, hole)
    # Where it is exact, contours show its place alone.
    for tolerance in TOLERANCES[1:] if exact is None else TOLERANCES[:1]:
        fits = [each.beside(tolerance) for each in (one, hole)]
        a, b = (Pieces.around([fit.contour]) for fit in fits)
        apart = least_distance(a, b) if exact is None else exact
        unsure = sum(fit.deviation for fit in fits)
        if exact is not None or abs(apart - compared) > unsure:
            break
    if exact is None:
        apart = _beside_flank(one, hole, apart, unsure)
    around = fits[1].contour
    points = around.points(around.length / POINTS**2)
    place = complex(points[np.argmin(distances(points, a))])
    return Web(one.name, hole.name, apart, usual, place)


def _beside_flank(one: Boundary, hole: Boundary, apart: float, unsure: float) -> float:
    """The web [mm] between a flank and lines and arcs, by the feet of their corners and centres on
    the flank; `apart`, which is within `unsure` of it, where none of these is nearest.
    """
    flank, other = (one, hole) if isinstance(one, CurveBoundary) else (hole, one)
    if not isinstance(flank, CurveBoundary) or not isinstance(other, ExactBoundary):
        return apart
    exact = other.exact
    arcs = exact.sweeps != 0.0
    points = np.concatenate((exact.vertices, exact.centres[arcs]))
    radii = np.concatenate((np.zeros(len(exact)), exact.radii[arcs]))
    feet = ExactFlank(flank.path, Flank.INNER).feet(points)
    found = np.abs(feet.distances) - radii
    found = found[np.abs(found - apart) <= unsure]
    return float(np.min(found)) if len(found) else apart


def _about_the_axis(one: Boundary, hole: Boundary) -> float | None:
    """The web [mm] within `one`, if that or the hole is a circle about the cam axis."""
    radius = _radius(hole)
    if radius is not None:
        return one.nearest() - radius
    radius = _radius(one)
    return None if radius is None else radius - hole.farthest()[0]


def _radius(boundary: Boundary) -> float | None:
    """Of a circle about the cam axis [mm]; None of anything else."""
    if not isinstance(boundary, ExactBoundary):
        return None
    exact = boundary.exact
    if exact.arc_count < len(exact) or np.any(exact.centres != 0.0):
        return None
    return float(exact.radii[0])


def _usual(one: Boundary, hole: Boundary) -> float:
    """Thickness of a web [mm], by the circle of the same area as the larger hole."""
    holes = [each for each in (one, hole) if each.hole and isinstance(each, ExactBoundary)]
    areas = [abs(each.exact.area) for each in holes]
    return SHARE * 2.0 * math.sqrt(max(areas, default=0.0) / math.pi)
