"""The thinnest material between two boundaries of a part."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import distances, least_distance
from camgeo.contour.pieces import Pieces
from camgeo.contour.simple import winding_number
from camgeo.part.boundaries import ExactBoundary
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


@dataclass(frozen=True, slots=True)
class Web:
    """Material between two boundaries.

    Attributes
    ----------
    one, other : their names, the other one that of a hole.
    thickness : the smallest distance between them [mm]; beside a circle about the cam axis exact,
        else within the second of `TOLERANCES`, or the last if that decides how it compares.
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
    """The web that is thinnest; without a `limit` [mm], that which is thinnest beside its usual
    thickness. None if the part has no holes.

    It is as exact as its comparison with the limit or that thickness takes.

    Raises
    ------
    UndercutError, ToleranceError
        If a boundary has no contour.
    """
    known: set[tuple[str, str]] = set()
    found: Web | None = None
    for layer in part.layers:
        for pair in combinations(_walled(layer), 2):
            one, hole = pair if pair[1].hole else pair[::-1]
            names = one.name, hole.name
            if names in known or not hole.hole:
                continue
            known.add(names)
            if found is not None and _least(one, hole, limit) > _size(found, limit)[0]:
                continue
            if _material_between(one, hole):
                web = _web(one, hole, limit)
                found = web if found is None or _size(web, limit) < _size(found, limit) else found
    return found


def surely_thick(part: Part, limit: float | None = None) -> bool:
    """Whether circles about the boundaries suffice to show that no web is thinner than the `limit`
    [mm], or than its usual thickness; raises like `thinnest`.
    """
    return all(
        _least(*(pair if pair[1].hole else pair[::-1]), limit) >= (1.0 if limit is None else limit)
        for layer in part.layers
        for pair in combinations(_walled(layer), 2)
        if pair[0].hole or pair[1].hole
    )


def _walled(layer: Layer) -> list[Boundary]:
    """Its boundaries but for those of letters: what is left beside their strokes bears nothing."""
    return [each for each in layer.boundaries if not text_of(each.name)]


def _size(web: Web, limit: float | None) -> tuple[float, float]:
    """By which webs are compared."""
    return _relative(web.thickness, web.usual, limit), web.thickness


def _relative(thickness: float, usual: float, limit: float | None) -> float:
    if limit is not None:
        return thickness
    return thickness / usual if usual else math.inf


def _least(one: Boundary, hole: Boundary, limit: float | None) -> float:
    """A lower bound of `_size` of a web, from circles about two holes, or about the cam axis within
    an outline and around a hole.
    """
    if not one.hole:
        apart = one.nearest() - hole.farthest()[0]
        return _relative(max(0.0, apart), _usual(one, hole), limit)
    circles = []
    for each in (one, hole):
        fit = each.beside(TOLERANCES[0])
        fine = fit.contour.split(STEP)
        middle = complex(np.mean(fine.vertices))
        sagitta = float(np.max(fine.radii)) * (1.0 - math.cos(0.5 * STEP))
        reach = float(np.max(np.abs(fine.vertices - middle))) + sagitta
        circles.append((middle, reach))
    (a, of_a), (b, of_b) = circles
    return _relative(max(0.0, abs(a - b) - of_a - of_b), _usual(one, hole), limit)


def _material_between(one: Boundary, hole: Boundary) -> bool:
    """Whether there is material between two boundaries of a section but for other boundaries."""
    a, b = (each.beside(TOLERANCES[0]).contour for each in (one, hole))
    if one.hole:
        return not (_inside(a, b) or _inside(b, a))
    return _inside(b, a)


def _inside(contour: Contour, around: Contour) -> bool:
    return winding_number(around, complex(contour.vertices[0])) != 0


def _web(one: Boundary, hole: Boundary, limit: float | None) -> Web:
    usual = _usual(one, hole)
    exact = None if one.hole else _about_the_axis(one, hole)
    # Where it is exact, contours show its place alone.
    for tolerance in TOLERANCES[1:] if exact is None else TOLERANCES[:1]:
        fits = [each.beside(tolerance) for each in (one, hole)]
        a, b = (Pieces.around([fit.contour]) for fit in fits)
        apart = least_distance(a, b) if exact is None else exact
        unsure = sum(fit.deviation for fit in fits)
        if exact is not None or abs(apart - (usual if limit is None else limit)) > unsure:
            break
    around = fits[1].contour
    points = around.points(around.length / POINTS**2)
    place = complex(points[np.argmin(distances(points, a))])
    return Web(one.name, hole.name, apart, usual, place)


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
