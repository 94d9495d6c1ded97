"""The layers of a part, from features that each bound it between two heights."""

from __future__ import annotations

import cmath
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import surely_apart
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.part.bevels import bevelled
from camgeo.part.boundaries import ExactBoundary, largest_radius
from camgeo.part.engraving import ENGRAVING, Engraving
from camgeo.part.faces import BOTH, LOWER, UPPER
from camgeo.part.features import (
    COUNTERBORE,
    bore_boundary,
    counterbore_boundaries,
    hole_boundaries,
    mark_boundary,
)
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import Counterbore, Holes, Hub, PartSpec, SetScrew

UPPER_HUB: Final = "hub"
LOWER_HUB: Final = "lower hub"
"""Names of hubs, and of their layers."""


@dataclass(frozen=True, slots=True)
class Feature:
    """A boundary between two heights.

    Attributes
    ----------
    boundary : of the part.
    z0, z1 : between which it bounds the part [mm].
    layer : name of the layer that begins at its lower end; empty if it gives none a name.
    """

    boundary: Boundary
    z0: float
    z1: float
    layer: str = ""


HUBS: Final = (UPPER_HUB, LOWER_HUB)

HOLES: Final = {"bolt_circle": "bolt hole", "lightening_holes": "lightening hole"}
"""Tables of holes, with the name of each hole."""


def stacked(features: Sequence[Feature]) -> tuple[Layer, ...]:
    """The layers between all heights at which a feature begins or ends, from the lowest upwards.

    Each has the boundaries of the features that are there, in their order.
    """
    heights = sorted({z for each in features for z in (each.z0, each.z1)})
    found = []
    for low, high in pairwise(heights):
        there = tuple(each.boundary for each in features if each.z0 <= low and high <= each.z1)
        names = [each.layer for each in features if each.z0 == low and each.layer]
        found.append(Layer(low, high, there, names[-1] if names else "disc"))
    return tuple(found)


def assembled(
    spec: PartSpec,
    outer: Boundary,
    flanks: Sequence[Boundary],
    rooms: tuple[Boundary, Boundary],
    tolerance: float,
) -> Part:
    """The part of a disc.

    Parameters
    ----------
    spec : the scene's specification.
    outer : outermost boundary of the disc.
    flanks : its other flanks: two of a groove, sunk to its depth, or one through the disc.
    rooms : within which a hub on the upper and on the lower face must stay.
    tolerance : by which boundaries must at least lie apart [mm], and of the contours that show it.

    Raises
    ------
    GeometryError
        With the key of the scene, if a feature has no room.
    """
    sunk = max(
        (each.depth for each in (spec.mark, *spec.engraving) if each is not None), default=0.0
    )
    if spec.bolt_circle is not None and spec.bolt_circle.counterbore is not None:
        sunk = max(sunk, spec.bolt_circle.counterbore.depth)
    depth = spec.groove_depth or 0.0
    # What the scene does not give is taken as anything that keeps the order, and is 0 in the end.
    bottom = -(spec.thickness or 2.0 * max(sunk, depth) + 1.0)
    floor = -depth or 0.5 * (bottom - sunk)
    grooved = len(flanks) > 1
    low, high = bottom, 0.0
    features = [Feature(outer, bottom, 0.0, "disc")]
    if spec.hub is not None:
        hubs = list(_hubs(spec.hub, bottom))
        for each, room in zip(hubs, _rooms_of(spec.hub, rooms), strict=True):
            _require_room(spec.hub, room, tolerance)
            low, high = min(low, each.z0), max(high, each.z1)
        features += hubs
    if spec.bore is not None:
        bore = bore_boundary(spec.bore, spec.keyway, spec.d_shaft)
        if spec.hub is not None:
            _require_within(bore, spec.hub)
        features.append(Feature(bore, low, high))
    name = "groove" if grooved else ""
    features += [Feature(each, floor if grooved else bottom, 0.0, name) for each in flanks]
    under: list[Feature] = []  # each clear of all else, as the wider mouth above it is
    for table, name in HOLES.items():
        holes: Holes | None = getattr(spec, table)
        if holes is None:
            continue
        for hole, wide in zip(
            hole_boundaries(holes, name), counterbore_boundaries(holes), strict=True
        ):
            mouth = wide or hole
            hub = _require_clear(mouth, f"part.{table}", features, tolerance)
            foot, top = (low, high) if hub else (bottom, 0.0)
            if hub and spec.set_screw is not None:
                _require_beside(mouth, spec.set_screw)
            if holes.counterbore is None:
                features.append(Feature(hole, foot, top))
                continue
            seat = _seat(holes.counterbore, foot, top, known=spec.thickness is not None)
            features.append(Feature(mouth, seat, top, COUNTERBORE))
            under.append(Feature(hole, foot, seat))
    if spec.mark is not None:
        mark = mark_boundary(spec.mark)
        upper = [each for each in features if each.layer != LOWER_HUB]
        if hub := _require_clear(mark, "part.mark", upper, tolerance):
            raise GeometryError(f"the mark lies under the {hub}", key="part.mark")
        features.append(Feature(mark, -spec.mark.depth, 0.0, "mark"))
    if spec.engraving:
        features += _engraved(spec.engraving, features, tolerance)
    features += under

    def stated(z: float) -> float:
        """The height `z` as far as the scene gives it."""
        lacking = grooved and spec.groove_depth is None and bottom < z < 0.0
        return 0.0 if spec.thickness is None or lacking else z

    layers = stacked(features)
    part = Part(
        tuple(
            Layer(stated(each.z0), stated(each.z1), each.boundaries, each.name) for each in layers
        )
    )
    return part if spec.chamfers is None else bevelled(part, spec.chamfers, tolerance)


def _hubs(hub: Hub, bottom: float) -> Iterable[Feature]:
    circle = Contour.circle(0.5 * hub.diameter)
    if hub.side in (UPPER, BOTH):
        upper = ExactBoundary(UPPER_HUB, hole=False, exact=circle)
        yield Feature(upper, 0.0, hub.height, UPPER_HUB)
    if hub.side in (LOWER, BOTH):
        lower = ExactBoundary(LOWER_HUB, hole=False, exact=circle)
        yield Feature(lower, bottom - hub.height, bottom, LOWER_HUB)


def _engraved(
    texts: Sequence[Engraving], features: Sequence[Feature], tolerance: float
) -> Iterable[Feature]:
    """The letters of texts, clear of each other and of all `features`."""
    from camgeo.part.engraved import require_room  # few parts are engraved
    from camgeo.part.lettering import lettered

    letters = lettered(texts)
    beside = (each.boundary for each in features if each.layer not in HUBS)
    hubs = (each.boundary for each in features if each.layer == UPPER_HUB)
    require_room(letters, beside, hubs, tolerance)
    for number, (text, each) in enumerate(zip(texts, letters, strict=True), start=1):
        for letter in each:
            for boundary in letter.boundaries:
                yield Feature(boundary, -text.depth, 0.0, f"{ENGRAVING} {number}")


def _rooms_of(hub: Hub, rooms: tuple[Boundary, Boundary]) -> tuple[Boundary, ...]:
    return {UPPER: rooms[:1], LOWER: rooms[1:], BOTH: rooms}[hub.side]


def _require_room(hub: Hub, room: Boundary, tolerance: float) -> None:
    """GeometryError unless the hub stands within `room`."""
    nearest = room.nearest()
    if 0.5 * hub.diameter + tolerance >= nearest:
        raise GeometryError(
            f"the hub reaches {0.5 * hub.diameter:.6g} mm from the cam axis, but the {room.name}"
            f" comes as near as {nearest:.6g} mm",
            key="part.hub.diameter",
            value=f"{hub.diameter:g}",
        )


def _require_within(bore: ExactBoundary, hub: Hub) -> None:
    """GeometryError unless the bore with its keyway lies within the hub."""
    reach = largest_radius(bore.exact)
    if reach >= 0.5 * hub.diameter:
        raise GeometryError(
            f"must be more than {2.0 * reach:.6g} mm, for the bore with its keyway reaches"
            f" {reach:.6g} mm from the cam axis",
            key="part.hub.diameter",
            value=f"{hub.diameter:g}",
        )


def _require_beside(hole: ExactBoundary, screw: SetScrew) -> None:
    """GeometryError unless a hole through the hub lies beside the radial hole of a set screw."""
    middle = complex(hole.exact.centres[0]) * cmath.exp(-1j * screw.angle)
    away = abs(middle.imag) if middle.real > 0.0 else abs(middle)
    if away <= hole.round_radius + 0.5 * screw.diameter:
        message = f"the hole of the set screw meets the {hole.name}"
        raise GeometryError(message, key="part.set_screw.angle")


def _seat(counterbore: Counterbore, foot: float, top: float, *, known: bool) -> float:
    """Height of the floor of a counterbore in material from `foot` to `top` [mm]; GeometryError
    unless there is some below it, if the heights are `known`.
    """
    if known and counterbore.depth >= top - foot:
        raise GeometryError(
            f"must be less than {top - foot:.6g} mm, the height of the material there",
            key="part.bolt_circle.counterbore.depth",
            value=f"{counterbore.depth:g}",
        )
    return top - counterbore.depth


def _require_clear(
    boundary: ExactBoundary, key: str, others: Iterable[Feature], tolerance: float
) -> str:
    """The name of a hub within which a hole or mark lies, the upper one if there is; empty if it
    lies beside them.

    Raises
    ------
    GeometryError
        With `key`, if it touches another feature or lies where the disc has no material.
    """
    own, start = boundary.beside(tolerance), complex(boundary.exact.vertices[0])
    around = 0
    covering = ""
    for each in others:
        other = each.boundary
        fit = other.beside(tolerance)
        if surely_apart(own, fit) <= 0.0:
            message = f"the {boundary.name} must lie clear of the {other.name}, which it touches"
            raise GeometryError(message, key=key)
        if winding_number(boundary.exact, complex(fit.contour.vertices[0])):
            raise GeometryError(f"the {boundary.name} lies around the {other.name}", key=key)
        inside = winding_number(fit.contour, start) != 0
        if each.layer in HUBS:
            covering = covering or (other.name if inside else "")
        else:
            around += inside
    if not around % 2:
        message = f"the {boundary.name} lies where the disc has no material"
        raise GeometryError(message, key=key)
    return covering
