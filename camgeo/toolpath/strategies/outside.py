"""Roughing of an outside: a spiral from the outline of the blank to the wall."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import phase
from camgeo.part.part import Boundary
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.leads import Beside, begun, lead_at
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.parallel import grown
from camgeo.toolpath.plane.spiral import Morph, engagements, fitted
from camgeo.toolpath.plane.star import Star
from camgeo.toolpath.plane.track import Track, chained
from camgeo.toolpath.strategies.area import (
    along,
    coarse,
    flattest_direction,
    limit_of,
    off_joints,
    require_clear,
    spiral,
    star_of,
)
from camgeo.toolpath.strategies.walk import Walk

MOST_TRIALS, MORE = 20, 0.02
"""Of a depth's spiral, and by which share its turns grow each time."""

ROOM = 0.75
"""Of a lead, as a share of the cutter's radius."""


def outside(cut: AreaCut, wall: Boundary, heights: Heights, tolerance: float) -> list[Move]:
    """At each depth: from where the cutter first touches the blank once around it after the other,
    ever nearer to the wall, and a full round along it.

    Down in the air beside the blank, and out there again between depths without being lifted: each
    depth begins in the direction in which the one before has ended.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall, the blank too small, or no spiral possible.
    """
    if cut.stock is None:
        raise GeometryError(f"{cut.name} needs the outline of the blank", "stock")
    fine = coarse(cut, tolerance)
    path = along(wall, cut, fine)
    edge = _edge(cut, cut.stock.arcs(fine, "fast").contour, path)
    begin, end = star_of(edge, "blank"), star_of(path, wall.name)
    walk = Walk(cut, heights)
    morph = spiral(cut, begin, end, flattest_direction(path), fine, outward=False)
    for number, z in enumerate(cut.depths):
        if number:
            morph = _continued(cut, morph, walk.place, fine)
        track = _level(cut, morph, path, fine)
        require_clear(track, wall, cut, fine)
        walk.over(track.start, Track.around(path))
        walk.down(z)
        walk.follow(track)
    walk.up()
    return walk.moves


def spirals(cut: AreaCut, wall: Boundary, tolerance: float) -> bool:
    """Whether rays from the cam axis meet both the wall's path and the edge of the blank once, so
    that a spiral leads from one to the other.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall, or the blank is not convex.
    """
    assert cut.stock is not None  # the caller has a blank
    fine = coarse(cut, tolerance)
    edge = grown(cut.stock.arcs(fine, "fast").contour, cut.tool.radius)
    return Star.of(edge) is not None and Star.of(along(wall, cut, fine)) is not None


def _level(cut: AreaCut, morph: Morph, path: Contour, fine: float) -> Track:
    """The way at one depth: onto the spiral, along it, once round, and off."""
    morph = replace(morph, finish=off_joints(path, morph.b, morph.finish))
    turned = fitted(morph, fine)
    last = begun(path, morph.b.along(morph.finish))
    if morph.sense < 0:
        last = last.reversed()
    radius = cut.tool.radius
    return chained(
        (_entry(morph, turned, radius), turned, Track.around(last), *_off(last, morph, radius))
    )


def _entry(morph: Morph, turned: Track, radius: float) -> Track:
    """A quarter turn from the air onto the beginning of the spiral."""
    free = -morph.side
    centre = turned.start + free * 1j * turned.headings[0] * ROOM * radius
    return Track.arc(turned.start, centre, -free * 0.5 * np.pi).reversed()


def _continued(cut: AreaCut, morph: Morph, place: complex, fine: float) -> Morph:
    """The spiral of the next depth: onto it the way is straight out from `place`, where the one
    before it has ended.

    It ends elsewhere, so that it may take slightly more turns to keep the engagement.
    """
    limit = limit_of(cut, fine)
    for _ in range(MOST_TRIALS):
        turned = fitted(morph, fine)
        aside = phase(_entry(morph, turned, cut.tool.radius).start / turned.start)
        finish = phase(place) - aside + morph.sense * 2.0 * np.pi * morph.turns
        morph = replace(morph, finish=finish)
        if float(np.max(engagements(morph, cut.tool.radius))) <= limit:
            break
        morph = replace(morph, turns=morph.turns * (1.0 + MORE))
    return morph


def _off(last: Contour, morph: Morph, radius: float) -> tuple[Track, ...]:
    """The way off the last round, none where there is no room for one."""
    for size in (ROOM * radius, 0.3 * radius, 0.1 * radius):
        lead = lead_at(last, size, Beside(free=-morph.side, usual=radius))
        if lead is not None:
            return (lead.off,)
    return ()


def _edge(cut: AreaCut, blank: Contour, path: Contour) -> Contour:
    """The path on which the cutter touches the blank, or all round outside the last path.

    Raises
    ------
    GeometryError
        With key "stock", if the blank does not contain the part with its allowance.
    """
    radius = cut.tool.radius
    edge = grown(blank, radius)
    outer, inner = star_of(edge, "blank"), star_of(path, "wall")
    lacking = inner.distances(beyond=outer).highest.value
    if lacking > 0.5 * radius:
        raise GeometryError(
            f"the blank is too small: {lacking:.3g} mm are missing at one side of the part",
            key="stock",
        )
    if lacking >= 0.0:
        edge = grown(blank, radius + 1.1 * lacking + 1e-3)
    return edge
