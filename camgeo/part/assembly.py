"""The part built from a scene's numbers and the flanks of the cam."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import (
    Contour,
    Pieces,
    least_distance,
    proved_gap,
    winding_number,
)
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path, radii
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.lazy import Ledger
from camgeo.numeric.checked import positive
from camgeo.part.boundaries import (
    CurveBoundary,
    ExactBoundary,
    Letter,
    contour_bytes,
    largest_radius,
    place_letters,
)
from camgeo.part.part import RETURN_PREFIX, Bevel, Boundary, Layer, Part, Wall
from camgeo.part.spec import (
    BOTH,
    DISCS,
    ENGRAVING,
    KEY,
    LOWER,
    MAIN,
    UPPER,
    Chamfer,
    Chamfers,
    Counterbore,
    DShaft,
    Engraving,
    Holes,
    Hub,
    Keyway,
    Mark,
    Pair,
    PartSpec,
    SetScrew,
)
from camgeo.units import TURN, at_cam_angles


def build_part(
    contact: Contact,
    inner: Path,
    outer: Path,
    spec: PartSpec,
    tolerance: float,
    ledger: Ledger | None = None,
) -> Part:
    """The part for one contact.

    Parameters
    ----------
    contact : flank on which the roller runs.
    inner, outer : the real outlines of the flanks; only those of the contact are used.
    spec : the scene's specification of the part.
    tolerance : least distance [mm] by which a boundary must lie inside another, so that contours of
        both that are as exact as that do not touch.
    ledger : records fits of the flanks.

    Raises
    ------
    GeometryError
        With the key of the scene, if a bore or a hub does not fit inside the disc, a flank does not
        fit inside the rim, or a mark is not clear of all of these.
    """
    return PARTS[contact](inner, outer, spec, tolerance, ledger or Ledger())


def _plate(inner: Path, _: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A disc whose outline is the inner flank."""
    outline = CurveBoundary("outline", hole=False, path=inner, ledger=book)
    _bore_fits(spec, outline, tolerance)
    return assemble_part(spec, outline, (), (outline, outline), tolerance)


def _ring(_: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a hole whose outline is the outer flank: there is no room for bore and hub."""
    if spec.hub is not None:
        raise GeometryError("the roller runs where it would be", key="part.hub")
    rim = _rim(spec, outer, tolerance, book)
    flank = CurveBoundary("outline", hole=True, path=outer, ledger=book)
    return assemble_part(
        replace(spec, bore=None, keyway=None, d_shaft=None), rim, (flank,), (rim, rim), tolerance
    )


def _grooved(inner: Path, outer: Path, spec: PartSpec, tolerance: float, book: Ledger) -> Part:
    """A blank with a groove between both flanks."""
    rim = _rim(spec, outer, tolerance, book)
    groove = (
        CurveBoundary("inner flank", hole=False, path=inner, ledger=book),
        CurveBoundary("outer flank", hole=True, path=outer, ledger=book),
    )
    _bore_fits(spec, groove[0], tolerance)
    return assemble_part(spec, rim, groove, (groove[0], rim), tolerance)


PARTS: Final = {Contact.INNER: _plate, Contact.OUTER: _ring, Contact.GROOVE: _grooved}
"""Functions that build the part, by the flank on which the roller runs."""


def _rim(spec: PartSpec, outer: Path, tolerance: float, book: Ledger) -> ExactBoundary:
    if spec.rim is None:
        raise GeometryError("a groove or inside cam needs the diameter of its rim", key="part.rim")
    flank = CurveBoundary("outer flank", hole=True, path=outer, ledger=book)
    needed = 2.0 * (flank.farthest()[0] + tolerance)
    if spec.rim <= needed:
        raise GeometryError(
            f"the rim must lie outside the outer flank: more than {needed:.6g} mm",
            key="part.rim",
            value=f"{spec.rim:g}",
        )
    return ExactBoundary("rim", hole=False, exact=Contour.circle(spec.rim / 2.0))


def _bore_fits(spec: PartSpec, flank: CurveBoundary, tolerance: float) -> None:
    """GeometryError unless the flank surrounds bore and keyway.

    The keyway may point in a direction in which there is more room than elsewhere.
    """
    if spec.bore is None:
        return
    outline = bore_outline(spec.bore, spec.keyway)
    reach = largest_radius(outline)
    # Three tests of growing precision: bounds of the pitch curve, the flank's exact least radius,
    # and contours of both, which tell the direction of the keyway.
    if flank.surely_around(reach + tolerance):
        return
    room = flank.nearest()
    if reach + tolerance < room:
        return
    if 0.5 * spec.bore + tolerance < room:
        fit = flank.distance_fit(tolerance)
        distance = least_distance(Pieces.around([outline]), Pieces.around([fit.contour]))
        if distance > fit.deviation:
            return
    raise GeometryError(
        f"the bore reaches {reach:.6g} mm from the cam axis, but the {flank.name} comes as near"
        f" as {room:.6g} mm",
        key="part.bore",
        value=f"{spec.bore:g}",
    )


# -- assembly -------------------------------------------------------------------------------------
# The layers of a part, from features that each bound it between two heights.


UPPER_HUB: Final = "hub"
LOWER_HUB: Final = "lower hub"
"""Names of hubs, and of their layers."""


@dataclass(frozen=True, slots=True)
class Feature:
    """A boundary between two heights.

    Attributes
    ----------
    boundary : the boundary, which the part shares.
    z0, z1 : heights between which it bounds the part [mm].
    layer : name of the layer that begins at the lower height; empty if the feature names none.
    """

    boundary: Boundary
    z0: float
    z1: float
    layer: str = ""


HUBS: Final = (UPPER_HUB, LOWER_HUB)
"""Names of all layers that are hubs."""

HOLES: Final = {"bolt_circle": "bolt hole", "lightening_holes": "lightening hole"}
"""Tables of holes, with the name of each hole."""


def stack_layers(features: Sequence[Feature]) -> tuple[Layer, ...]:
    """The layers between all heights at which a feature begins or ends, from the lowest upwards.

    Each has the boundaries of the features that are there, in their order.
    """
    heights = sorted({z for feature in features for z in (feature.z0, feature.z1)})
    layers = []
    for low, high in pairwise(heights):
        boundaries = tuple(
            feature.boundary for feature in features if feature.z0 <= low and high <= feature.z1
        )
        names = [feature.layer for feature in features if feature.z0 == low and feature.layer]
        layers.append(Layer(low, high, boundaries, names[-1] if names else "disc"))
    return tuple(layers)


def assemble_part(
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
    flanks : other flanks of the disc: two of a groove, sunk to its depth, or one through the disc.
    rooms : boundaries within which a hub on the upper and on the lower face must stay.
    tolerance : least distance of boundaries [mm], and tolerance of the contours that show it.

    Raises
    ------
    GeometryError
        With the key of the scene, if a feature has no room.
    """
    sunk = max(
        (feature.depth for feature in (spec.mark, *spec.engraving) if feature is not None),
        default=0.0,
    )
    if spec.bolt_circle is not None and spec.bolt_circle.counterbore is not None:
        sunk = max(sunk, spec.bolt_circle.counterbore.depth)
    depth = spec.groove_depth or 0.0
    # Heights that the scene does not give are invented so that the order of the layers is right;
    # `stated` sets them to 0 in the end.
    bottom = -(spec.thickness or 2.0 * max(sunk, depth) + 1.0)
    # Without a depth the floor is halfway between the deepest mark or text and the lower face.
    floor = -depth or 0.5 * (bottom - sunk)
    grooved = len(flanks) > 1
    low, high = bottom, 0.0
    features = [Feature(outer, bottom, 0.0, "disc")]
    if spec.hub is not None:
        hubs = list(_hubs(spec.hub, bottom))
        for feature, room in zip(hubs, _hub_rooms(spec.hub, rooms), strict=True):
            _require_room(spec.hub, room, tolerance)
            low, high = min(low, feature.z0), max(high, feature.z1)
        features += hubs
    if spec.bore is not None:
        bore = bore_boundary(spec.bore, spec.keyway, spec.d_shaft)
        if spec.hub is not None:
            _require_bore_in_hub(bore, spec.hub)
        features.append(Feature(bore, low, high))
    name = "groove" if grooved else ""
    features += [Feature(flank, floor if grooved else bottom, 0.0, name) for flank in flanks]
    lower_holes: list[Feature] = []  # each clear of all else, as the wider mouth above it is
    for table, name in HOLES.items():
        holes: Holes | None = getattr(spec, table)
        if holes is None:
            continue
        for number, middle in enumerate(holes.middles, start=1):
            hole, wide = hole_boundary(f"{name} {number}", holes.hole, middle), holes.counterbore
            mouth = (
                hole
                if wide is None
                else hole_boundary(f"{COUNTERBORE} {number}", wide.diameter, middle)
            )
            hub = _require_clear(mouth, f"part.{table}", features, tolerance)
            foot, top = (low, high) if hub else (bottom, 0.0)
            if hub and spec.set_screw is not None:
                _require_clear_of_screw(mouth, spec.set_screw)
            if holes.counterbore is None:
                features.append(Feature(hole, foot, top))
                continue
            seat = _seat(holes.counterbore, foot, top, known=spec.thickness is not None)
            features.append(Feature(mouth, seat, top, COUNTERBORE))
            lower_holes.append(Feature(hole, foot, seat))
    if spec.mark is not None:
        mark = ExactBoundary("mark", hole=True, exact=mark_outline(spec.mark))
        # The mark is in the upper face, so it may lie above the lower hub.
        upper = [feature for feature in features if feature.layer != LOWER_HUB]
        if hub := _require_clear(mark, "part.mark", upper, tolerance):
            raise GeometryError(f"the mark lies under the {hub}", key="part.mark")
        features.append(Feature(mark, -spec.mark.depth, 0.0, "mark"))
    if spec.engraving:
        features += _engraving_features(spec.engraving, features, tolerance)
    features += lower_holes

    def stated(z: float) -> float:
        """The height `z` as far as the scene gives it."""
        lacking = grooved and spec.groove_depth is None and bottom < z < 0.0
        return 0.0 if spec.thickness is None or lacking else z

    layers = stack_layers(features)
    part = Part(
        tuple(
            Layer(stated(layer.z0), stated(layer.z1), layer.boundaries, layer.name)
            for layer in layers
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


def _engraving_features(
    texts: Sequence[Engraving], features: Sequence[Feature], tolerance: float
) -> Iterable[Feature]:
    """The letters of texts, clear of each other and of all `features`."""
    letters = place_letters(texts)
    boundaries = (feature.boundary for feature in features if feature.layer not in HUBS)
    hubs = (feature.boundary for feature in features if feature.layer == UPPER_HUB)
    require_room(letters, boundaries, hubs, tolerance)
    for number, (text, text_letters) in enumerate(zip(texts, letters, strict=True), start=1):
        for letter in text_letters:
            for boundary in letter.boundaries:
                yield Feature(boundary, -text.depth, 0.0, f"{ENGRAVING} {number}")


def _hub_rooms(hub: Hub, rooms: tuple[Boundary, Boundary]) -> tuple[Boundary, ...]:
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


def _require_bore_in_hub(bore: ExactBoundary, hub: Hub) -> None:
    """GeometryError unless the bore with its keyway lies within the hub."""
    reach = largest_radius(bore.exact)
    if reach >= 0.5 * hub.diameter:
        raise GeometryError(
            f"must be more than {2.0 * reach:.6g} mm, for the bore with its keyway reaches"
            f" {reach:.6g} mm from the cam axis",
            key="part.hub.diameter",
            value=f"{hub.diameter:g}",
        )


def _require_clear_of_screw(hole: ExactBoundary, screw: SetScrew) -> None:
    """GeometryError unless a hole through the hub is clear of the radial hole of a set screw."""
    # In axes along the screw, whose hole runs from the cam axis outward.
    middle = complex(hole.exact.centres[0]) * cmath.exp(-1j * screw.angle)
    away = abs(middle.imag) if middle.real > 0.0 else abs(middle)
    if away <= hole.round_radius + 0.5 * screw.diameter:
        raise GeometryError(
            f"the hole of the set screw would meet the {hole.name}", key="part.set_screw.angle"
        )


def _seat(counterbore: Counterbore, foot: float, top: float, *, known: bool) -> float:
    """Height of the floor of a counterbore in material from `foot` to `top` [mm].

    GeometryError if no material is left below it, which is only tested if the heights are `known`.
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
    """Check that a hole or mark is clear of the other features and lies in material.

    Returns the name of the hub within which it lies, of the upper hub if it lies within both; empty
    if it lies in neither.

    Raises
    ------
    GeometryError
        With `key`, if it touches another feature or lies where the disc has no material.
    """
    boundary_fit, start = boundary.distance_fit(tolerance), complex(boundary.exact.vertices[0])
    around = 0
    covering = ""
    for feature in others:
        other = feature.boundary
        other_fit = other.distance_fit(tolerance)
        if proved_gap(boundary_fit, other_fit) <= 0.0:
            raise GeometryError(
                f"the {boundary.name} must lie clear of the {other.name}, which it touches", key=key
            )
        # As the two do not touch, one vertex tells whether one lies inside the other.
        if winding_number(boundary.exact, complex(other_fit.contour.vertices[0])):
            raise GeometryError(f"the {boundary.name} lies around the {other.name}", key=key)
        inside = winding_number(other_fit.contour, start) != 0
        if feature.layer in HUBS:
            covering = covering or (other.name if inside else "")
        else:
            around += inside
    # Boundaries are nested without crossing, so there is material inside an odd number of them.
    if not around % 2:
        raise GeometryError(f"the {boundary.name} lies where the disc has no material", key=key)
    return covering


# -- engraved -------------------------------------------------------------------------------------
# Whether engraved letters have room on the upper face of the disc.


def require_room(
    texts: Sequence[Sequence[Letter]],
    boundaries: Iterable[Boundary],
    hubs: Iterable[Boundary],
    tolerance: float,
) -> None:
    """Raise GeometryError with the key of a text, and the letter, unless all letters lie clear of
    other boundaries, on material of the disc and not under a hub.

    Parameters
    ----------
    texts : the letters of each text.
    boundaries : other boundaries on the upper face of the disc.
    hubs : the hubs that stand on that face.
    tolerance : tolerance of the contours by which boundaries are compared [mm]; their deviation is
        accounted for.
    """
    around: dict[Letter, int] = {}
    for boundary in (neighbours := tuple(boundaries)) + tuple(hubs):
        fit = boundary.distance_fit(tolerance)
        pieces = Pieces.around([fit.contour])
        for number, letters in enumerate(texts, start=1):
            key = f"part.{ENGRAVING}[{number}]"
            whole = Pieces.around(contour for letter in letters for contour in letter.contours)
            if least_distance(whole, pieces) <= fit.deviation + max(
                letter.deviation for letter in letters
            ):
                letter = min(letters, key=lambda letter: _letter_distance(letter, pieces))
                raise GeometryError(
                    f"must lie clear of the {boundary.name}, which the {letter.where} touches",
                    key=key,
                )
            for letter in letters:
                inside = winding_number(fit.contour, _start(letter.contours[0])) != 0
                if any(winding_number(outline, _start(fit.contour)) for outline in letter.contours):
                    raise GeometryError(
                        f"the {letter.where} lies around the {boundary.name}", key=key
                    )
                if boundary in neighbours:
                    around[letter] = around.get(letter, 0) + inside
                elif inside:
                    raise GeometryError(
                        f"the {letter.where} lies under the {boundary.name}", key=key
                    )
    for number, letters in enumerate(texts, start=1):
        for letter in letters:
            if not around[letter] % 2:
                raise GeometryError(
                    f"the {letter.where} lies where the disc has no material",
                    key=f"part.{ENGRAVING}[{number}]",
                )


def _start(contour: Contour) -> complex:
    return complex(contour.vertices[0])


def _letter_distance(letter: Letter, pieces: Pieces) -> float:
    return least_distance(Pieces.around(letter.contours), pieces)


# -- pair -----------------------------------------------------------------------------------------
# A conjugate pair in one piece: the layers of both discs, and of a spacer between them.
#
# Each disc is the part that it would be alone, but for the hub, which is that of the pair: the
# upper disc bears the hub on its upper face, the lower disc that on its lower face. Both discs are
# in cam coordinates, so the return disc is at 0 degrees to the main one.


SPACER: Final = "spacer"
"""Name of the boundary, and of its layer."""

SPACER_KEY: Final = "part.pair.spacer"
"""Key of the spacer's diameter in the scene."""


def build_pair(
    paths: tuple[Path, Path], spec: PartSpec, tolerance: float, ledger: Ledger | None = None
) -> Part:
    """The pair as one part, the upper face of its upper disc at height 0.

    Layers of the return disc have names that begin with `RETURN_PREFIX`, and so have its boundaries
    where the main disc has others of those names; what both have in the same place, as the bore, is
    one boundary.

    Parameters
    ----------
    paths : the real outlines of main disc and return disc.
    spec : the specification of the part, with the pair and a thickness.
    tolerance : as for `build_part`.
    ledger : records fits of the flanks.

    Raises
    ------
    GeometryError
        With the key of the scene, if one of the discs is impossible with what it bears, the spacer
        does not lie within both and around the bore, or a hole or mark is not clear of it.
    """
    pair = spec.pair
    if pair is None or spec.thickness is None:
        raise GeometryError("a pair in one piece needs its thickness", key="part.pair")
    parts: dict[str, Part] = {}
    for name, path in zip(DISCS, paths, strict=True):
        bearing = _bearing(spec, pair, name)
        try:
            parts[name] = build_part(Contact.INNER, path, path, bearing, tolerance, ledger)
        except GeometryError as error:
            raise GeometryError(f"{name} disc: {error.message}", error.key, error.value) from error
        _require_spacer_fits(pair, path, name, tolerance)
    other = tuple(_return_layers(*parts.values()))
    main = parts[MAIN].layers
    upper, lower = (main, other) if pair.upper == MAIN else (other, main)
    # The upper disc has its upper face at height 0 as it is; only the lower disc moves.
    down = spec.thickness + pair.gap
    lower = tuple(replace(layer, z0=layer.z0 - down, z1=layer.z1 - down) for layer in lower)
    circle = ExactBoundary(SPACER, hole=False, exact=Contour.circle(0.5 * pair.spacer))
    holes = _through_holes(circle, upper[0], lower[-1], tolerance)
    spacer = Layer(lower[-1].z1, upper[0].z0, (circle, *holes), SPACER)
    whole = Part((*lower, spacer, *upper))
    return whole if spec.chamfers is None else bevelled(whole, spec.chamfers, tolerance)


def _bearing(spec: PartSpec, pair: Pair, name: str) -> PartSpec:
    """The specification of a disc with the hub on its outer face, if there is one, and without
    chamfers.
    """
    disc, hub = replace(spec.alone(name), chamfers=None), spec.hub
    side = UPPER if name == pair.upper else LOWER
    if hub is None or hub.side not in (side, BOTH):
        return disc
    first = side == UPPER or hub.side == LOWER  # which has the set screw
    screw = spec.set_screw if first else None
    return replace(disc, hub=replace(hub, side=side), set_screw=screw)


def _require_spacer_fits(pair: Pair, path: Path, name: str, tolerance: float) -> None:
    nearest = radii(path).lowest
    if 0.5 * pair.spacer + tolerance >= nearest.value:
        raise GeometryError(
            f"the spacer reaches {0.5 * pair.spacer:.6g} mm from the cam axis, but the flank of the"
            f" {name} disc comes as near as {nearest.value:.6g} mm {at_cam_angles(nearest.place)}",
            key=SPACER_KEY,
            value=f"{pair.spacer:g}",
        )


def _return_layers(main: Part, other: Part) -> Iterator[Layer]:
    """The layers of the return disc under names of their own; boundaries that are the same in the
    main disc are that disc's objects.
    """
    main_boundaries = {boundary.name: boundary for boundary in main.boundaries}
    known: dict[str, Boundary] = {}

    def return_boundary(boundary: Boundary) -> Boundary:
        name = boundary.name
        flank: Any = boundary  # it shares only its name with one of the main disc
        if name not in known:
            shared = main_boundaries.get(name)
            if shared is None:
                known[name] = boundary
            else:
                known[name] = (
                    shared
                    if _alike(boundary, shared)
                    else replace(flank, name=f"{RETURN_PREFIX}{name}")
                )
        return known[name]

    outline = other.outermost
    for layer in other.layers:
        name = f"{RETURN_PREFIX}{layer.name}" if outline in layer.boundaries else layer.name
        yield replace(layer, boundaries=tuple(map(return_boundary, layer.boundaries)), name=name)


def _alike(one: Boundary, other: Boundary) -> bool:
    if not (isinstance(one, ExactBoundary) and isinstance(other, ExactBoundary)):
        return False
    return one.hole == other.hole and contour_bytes(one.exact) == contour_bytes(other.exact)


def _through_holes(
    circle: ExactBoundary, upper: Layer, lower: Layer, tolerance: float
) -> tuple[Boundary, ...]:
    """The holes that go through both discs, and therefore through the spacer.

    Raises GeometryError if one of them touches the spacer, or ends at it.
    """
    sides = [list(_inside(circle, layer, tolerance)) for layer in (upper, lower)]
    for one, other in (sides, sides[::-1]):
        for boundary in one:
            if boundary not in other:
                raise GeometryError(f"the {boundary.name} ends under the spacer", key=SPACER_KEY)
    return tuple(sides[0])


def _inside(circle: ExactBoundary, layer: Layer, tolerance: float) -> Iterator[Boundary]:
    """The boundaries of a disc that lie within the spacer."""
    ring = circle.distance_fit(tolerance)
    for boundary in layer.boundaries[1:]:
        fit = boundary.distance_fit(tolerance)
        if proved_gap(ring, fit) <= 0.0:
            raise GeometryError(
                f"the spacer must lie clear of the {boundary.name}, which it touches",
                key=SPACER_KEY,
            )
        if winding_number(fit.contour, complex(circle.exact.vertices[0])):
            raise GeometryError(f"the {boundary.name} lies around the spacer", key=SPACER_KEY)
        if winding_number(circle.exact, complex(fit.contour.vertices[0])):
            yield boundary


# -- features -------------------------------------------------------------------------------------
# The outlines of features: exactly lines and arcs.


COUNTERBORE: Final = "counterbore"
"""Name of counterbores, and of the layer that begins on their floors."""


def bore_boundary(
    diameter: float, keyway: Keyway | None, flat: DShaft | None = None
) -> ExactBoundary:
    """The bore as a boundary, with a keyway or a flat; raises like `bore_outline`."""
    if flat is not None:
        return ExactBoundary("bore", hole=True, exact=flattened(diameter, flat))
    core = None if keyway is None else Contour.circle(diameter / 2.0)
    return ExactBoundary("bore", hole=True, exact=bore_outline(diameter, keyway), core=core)


def bore_outline(diameter: float, keyway: Keyway | None) -> Contour:
    """The bore around the cam axis [mm], counter-clockwise: two half circles, or circle and slot.

    Raises
    ------
    GeometryError
        With key "part.keyway.width", if the slot is not narrower than the bore; with "part.bore",
        if the diameter is not above 0.
    """
    radius = positive("part.bore", diameter, "mm") / 2.0
    if keyway is None:
        return Contour.circle(radius)
    half = keyway.width / 2.0
    if half >= radius:
        raise GeometryError(
            f"the keyway must be narrower than the bore, {diameter:g} mm",
            key="part.keyway.width",
            value=f"{keyway.width:g}",
        )
    # In axes along the keyway's middle line: up the slot, across its bottom, down again.
    reach = math.sqrt(radius * radius - half * half)
    bottom = radius + keyway.depth
    corners = np.array(
        [reach - 1j * half, bottom - 1j * half, bottom + 1j * half, reach + 1j * half]
    )
    # The mouth of the slot takes this angle of the bore.
    opening = 2.0 * math.asin(half / radius)
    vertices = corners * cmath.exp(1j * keyway.angle)
    sweeps = np.array([0.0, 0.0, 0.0, 2.0 * math.pi - opening])
    return Contour(vertices, sweeps, np.zeros(4, dtype=np.complex128))


def flattened(diameter: float, flat: DShaft) -> Contour:
    """A bore with a flat about the cam axis [mm], counter-clockwise: up the flat, and round."""
    radius = 0.5 * diameter
    # Distance of the flat from the cam axis; sum and difference do not cancel as squares would.
    away = flat.across - radius
    half = math.sqrt((radius - away) * (radius + away))
    corners = cmath.exp(1j * flat.angle) * np.array([away - 1j * half, away + 1j * half])
    opening = 2.0 * math.acos(away / radius)
    return Contour(corners, np.array([0.0, TURN - opening]), np.zeros(2, dtype=np.complex128))


def hole_boundary(name: str, diameter: float, middle: complex) -> ExactBoundary:
    """A round hole as a boundary."""
    return ExactBoundary(name, hole=True, exact=Contour.circle(0.5 * diameter, middle))


def mark_outline(mark: Mark) -> Contour:
    """A circle, or a radial slot with round ends [mm], counter-clockwise.

    Raises
    ------
    GeometryError
        With key "part.mark.radius", if it reaches the cam axis.
    """
    half = 0.5 * mark.width
    straight = 0.0 if mark.length is None else 0.5 * mark.length - half
    if mark.radius <= half + straight:
        raise GeometryError(
            f"the mark must not reach the cam axis: more than {half + straight:.6g} mm",
            key="part.mark.radius",
            value=f"{mark.radius:g}",
        )
    along = cmath.exp(1j * mark.angle)
    if not straight:
        return Contour.circle(half, mark.radius * along)
    # In axes along the ray: outward on its right, round the outer end, and back on its left.
    near, far = mark.radius - straight, mark.radius + straight
    corners = np.array([near - 1j * half, far - 1j * half, far + 1j * half, near + 1j * half])
    centres = np.array([0.0, far, 0.0, near])
    return Contour(along * corners, np.array([0.0, math.pi, 0.0, math.pi]), along * centres)


# -- bevels ---------------------------------------------------------------------------------------
# The chamfers of a part: which edges have one, and whether there is room for it.


TABLES: Final = {
    "outline": "outline",
    "inner flank": "outline",
    "outer flank": "outline",
    "rim": "rim",
    "bore": "bore",
    "hub": "hub",
    "lower hub": "hub",
    "bolt hole": "bolt_circle",
    "counterbore": "bolt_circle",
    "lightening hole": "lightening_holes",
}
"""The fields of `Chamfers`, by the names of boundaries without a number."""


def bevelled(part: Part, chamfers: Chamfers, tolerance: float) -> Part:
    """The part with chamfers.

    Parameters
    ----------
    part : the part with all its heights and with sharp edges.
    chamfers : the scene's specification.
    tolerance : tolerance [mm] of the contours that show that chamfers stay clear of all else.

    Raises
    ------
    GeometryError
        With the key of the scene, if there is no room for a chamfer, or no edge to have it.
    """
    part.require_heights()
    bevels: list[Bevel] = []
    for field in fields(chamfers):
        chamfer: Chamfer | None = getattr(chamfers, field.name)
        if chamfer is None:
            continue
        new_bevels = list(_bevels(part, field.name, chamfer, tolerance))
        if not new_bevels:
            where = "" if chamfer.edges == BOTH else f" on the {chamfer.edges} side"
            raise GeometryError(f"there is no such edge{where}", key=f"{KEY}.{field.name}")
        bevels += new_bevels
    for bevel in bevels:
        _require_bevel_clear(bevel, bevels, part, tolerance)
    return replace(part, bevels=tuple(bevels))


def _table(boundary: Boundary) -> str:
    """The field of `Chamfers` that applies to a boundary; empty if none does."""
    name = boundary.name.removeprefix(RETURN_PREFIX)
    kind, _, number = name.rpartition(" ")
    return TABLES.get(kind if number.isdigit() else name, "")


def _bevels(part: Part, name: str, chamfer: Chamfer, tolerance: float) -> Iterator[Bevel]:
    """The bevels along all edges for which the chamfer `name` is stated."""
    key, width = f"{KEY}.{name}.width", chamfer.width
    for wall in part.walls:
        if _table(wall.boundary) != name:
            continue
        ends = [
            upper
            for upper, side in ((False, LOWER), (True, UPPER))
            if chamfer.edges in (side, BOTH) and _is_outer(part, wall, tolerance, upper=upper)
        ]
        if not ends:
            continue
        high = wall.z1 - wall.z0
        # Some of the wall must be left between two chamfers, or below one.
        if len(ends) * width >= high:
            raise GeometryError(
                f"must be less than {high / len(ends):.6g} mm, of a wall of {high:.6g} mm with"
                f" {'two such edges' if len(ends) > 1 else 'one such edge'}",
                key=key,
                value=f"{width:g}",
            )
        edge = _edge(wall.boundary, width, key)
        for upper in ends:
            z = wall.z1 if upper else wall.z0
            yield Bevel(wall.boundary, edge, width, width, z, upper=upper)


def _is_outer(part: Part, wall: Wall, tolerance: float, *, upper: bool) -> bool:
    """Whether a wall ends at a free face: neither at the foot of a hub, nor at the floor of a
    groove or a counterbore.
    """
    if upper:
        beyond = [layer for layer in part.layers if layer.z0 == wall.z1]
    else:
        beyond = [layer for layer in part.layers if layer.z1 == wall.z0]
    place = complex(wall.boundary.distance_fit(tolerance).contour.vertices[0])
    return not any(
        winding_number(boundary.distance_fit(tolerance).contour, place)
        for layer in beyond
        for boundary in layer.boundaries
    )


def _edge(boundary: Boundary, width: float, key: str) -> Boundary:
    """The inner edge of a chamfer, exact; GeometryError with the `key` if there is none."""
    name = f"chamfer of the {boundary.name}"
    if isinstance(boundary, CurveBoundary):
        _require_parallel(boundary, width, key)
    elif (
        isinstance(boundary, ExactBoundary)
        and not boundary.hole
        and width >= (radius := boundary.round_radius)
    ):
        raise GeometryError(
            f"must be less than the radius of the {boundary.name}, {radius:.6g} mm",
            key=key,
            value=f"{width:g}",
        )
    return boundary.inset(width, name)


def _require_parallel(boundary: CurveBoundary, width: float, key: str) -> None:
    """GeometryError unless the parallel at `width` [mm] within the material is whole.

    It is the flank that a roller larger by as much would make: where nothing of that is trimmed,
    the parallel neither has a cusp nor comes to itself, and nor do those between.
    """
    value = f"{width:g}"
    if any(pivot.distance == 0.0 for pivot in boundary.path.pivots):
        raise GeometryError(
            f"the {boundary.name} has a corner, along which there is no chamfer",
            key=key,
            value=value,
        )
    # All stretches of an outline lie on one curve.
    curve = boundary.path.stretches[0].curve
    sign = 1.0 if boundary.hole else -1.0
    limit, angle = _smallest_radius(curve, sign)
    if width >= limit:
        raise GeometryError(
            f"must be less than {limit:.6g} mm, the smallest radius of the {boundary.name} where it"
            f" goes round material, {at_cam_angles(angle)}",
            key=key,
            value=value,
        )
    if not curve.pitch.follower.has_pitch_curve:
        return  # the contact curve of a flat face is convex, and so are its parallels
    try:
        trimmed = real_outline(WorkingCurve(curve.pitch, curve.distance + sign * width)).is_trimmed
    except (GeometryError, UndercutError):
        trimmed = True
    if trimmed:
        raise GeometryError(
            f"is too large: the chamfer of the {boundary.name} would meet itself",
            key=key,
            value=value,
        )


def _smallest_radius(curve: WorkingCurve, sign: float) -> tuple[float, float]:
    """Smallest radius of curvature [mm] of a flank where it goes round material, and its cam angle
    [rad]; infinite if it does so nowhere.

    `sign` is +1 if the parallel within the material lies outward of the flank, else -1. A parallel
    of the pitch curve at d is regular while 1 + d kappa > 0.
    """
    bends = curvature_extremes(curve.pitch)
    bend, angle = bends.smallest() if sign > 0.0 else bends.largest()
    opposed = -sign * bend
    if opposed <= 0.0:
        return math.inf, angle
    return 1.0 / opposed - sign * curve.distance, angle


def _reach(bevel: Bevel) -> float:
    """Largest distance [mm] of the edge of a chamfer from its boundary: its width, or more at
    mitred corners.
    """
    wall, edge = bevel.boundary, bevel.edge
    if isinstance(wall, ExactBoundary) and isinstance(edge, ExactBoundary) and wall.corner_radius:
        return float(np.max(np.abs(edge.exact.vertices - wall.exact.counter_clockwise().vertices)))
    return bevel.width


def _heights(bevel: Bevel) -> tuple[float, float]:
    """The lower and the upper height of a chamfer [mm]."""
    return min(bevel.z, bevel.foot), max(bevel.z, bevel.foot)


def _require_bevel_clear(
    bevel: Bevel, bevels: Sequence[Bevel], part: Part, tolerance: float
) -> None:
    """GeometryError if a chamfer reaches another boundary, or its chamfer, at its heights."""
    low, high = _heights(bevel)
    near = {
        boundary.name: boundary
        for layer in part.layers
        if layer.z0 <= high and low <= layer.z1
        for boundary in layer.boundaries
        if boundary != bevel.boundary
    }
    fit = bevel.boundary.distance_fit(tolerance)
    for other in near.values():
        widths = (
            _reach(other_bevel)
            for other_bevel in bevels
            if other_bevel.boundary == other
            and _heights(other_bevel)[0] <= high
            and low <= _heights(other_bevel)[1]
        )
        distance = proved_gap(fit, other.distance_fit(tolerance))
        if distance <= _reach(bevel) + max(widths, default=0.0):
            name = _table(bevel.boundary)
            raise GeometryError(
                f"the chamfer of the {bevel.boundary.name} would reach the {other.name}, which is"
                f" {distance:.4g} mm away",
                key=f"{KEY}.{name}.width",
                value=f"{bevel.width:g}",
            )
