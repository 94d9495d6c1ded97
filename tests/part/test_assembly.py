"""Parts and pairs assembled from features, and what has no room."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.contour.contour import Contour, winding_number
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller, return_on_carriage
from camgeo.part.assembly import (
    bevelled,
    bore_outline,
    build_pair,
    build_part,
    flattened,
    mark_outline,
)
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.mass import Solid, disc_moments
from camgeo.part.part import Bevel, Layer, Part, part_edges
from camgeo.part.spec import (
    DISCS,
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
from tests.long_form import examples
from tests.part.parts import (
    DISC,
    FLANKS,
    PITCH,
    ROLLER,
    circle,
    made,
    made_or_refused,
    polygon_of,
    refused,
    specs,
    walls_of,
)
from tests.scene.scenes import PLATE, loaded
from tests.strategies import attack


def test_hub_on_the_upper_face() -> None:
    part = made(Contact.INNER, replace(DISC, hub=Hub(40.0, 6.0)))
    assert walls_of(part) == [("outline", -10.0, 0.0), ("bore", -10.0, 6.0), ("hub", 0.0, 6.0)]
    assert part.outermost.name == "outline"
    lower, shoulder, upper = part.levels
    assert [each.name for each in shoulder.below + shoulder.above] == ["outline", "hub"]
    assert (lower.z, shoulder.z, upper.z, part.thickness) == (-10.0, 0.0, 6.0, 16.0)
    assert [each.name for each in part.levels] == [
        "lower face", "upper face of the disc", "upper face",
    ]  # fmt: skip


def test_hubs_on_both_faces_of_a_groove_cam() -> None:
    part = made(Contact.GROOVE, replace(DISC, hub=Hub(40.0, 6.0, "both")))
    assert walls_of(part) == [
        ("lower hub", -16.0, -10.0),
        ("bore", -16.0, 6.0),
        ("rim", -10.0, 0.0),
        ("inner flank", -4.0, 0.0),
        ("outer flank", -4.0, 0.0),
        ("hub", 0.0, 6.0),
    ]
    assert part.outermost.name == "rim"
    assert [layer.name for layer in part.layers] == ["lower hub", "disc", "groove", "hub"]


@pytest.mark.parametrize(
    ("depth", "names"),
    [
        (1.0, ["disc", "groove", "mark"]),
        (4.0, ["disc", "mark"]),
        (5.0, ["disc", "mark", "groove"]),
    ],
)
def test_mark_beside_a_groove(depth: float, names: list[str]) -> None:
    part = made(Contact.GROOVE, replace(DISC, mark=Mark(22.0, 2.0, depth, 6.0)))
    assert [layer.name for layer in part.layers] == names
    assert walls_of(part)[-1 if depth <= 4.0 else 2] == ("mark", -depth, 0.0)


def test_a_drawing_needs_no_heights() -> None:
    spec = PartSpec(bore=20.0, hub=Hub(40.0, 6.0, "both"), mark=Mark(27.0, 2.0, 0.5))
    part = made(Contact.INNER, spec)
    assert {each.name for each in part.boundaries} == {
        "outline", "bore", "hub", "lower hub", "mark",
    }  # fmt: skip
    assert part.thickness == 0.0
    with refused("part.thickness", r"a solid needs part\.thickness"):
        _ = part.levels
    grooved = made(Contact.GROOVE, replace(spec, thickness=10.0, rim=140.0))
    with refused("part.groove_depth", r"a solid needs part\.groove_depth"):
        _ = grooved.levels


def test_a_solid_has_no_layer_within_its_tolerance() -> None:
    part = made(Contact.INNER, PartSpec(bore=20.0, thickness=10.0, hub=Hub(40.0, 0.015, "upper")))
    part.require_steps(0.01)
    with refused("part", r"0\.02 mm cannot have a layer of 0\.015 mm"):
        part.require_steps(0.02)
    thin = made(Contact.INNER, PartSpec(bore=20.0, thickness=1e-4))
    with refused("part.thickness"):
        thin.require_steps(0.01)


@given(
    st.floats(10.0, 60.0), st.floats(0.5, 4.0), st.floats(1.01, 4.0), st.floats(-6.2, 6.2)
)  # fmt: skip
@attack
def test_outline_of_a_mark(radius: float, width: float, slender: float, angle: float) -> None:
    length = min(slender * width, radius)
    contour = mark_outline(Mark(radius, width, 1.0, length, angle))
    straight = length - width
    assert contour.area == pytest.approx(
        0.25 * math.pi * width**2 + straight * width, rel=1e-9, abs=1e-12
    )
    along = contour.vertices * np.exp(-1j * angle)
    assert np.abs(along.imag) == pytest.approx(np.full(4, 0.5 * width))
    assert np.mean(along.real) == pytest.approx(radius)
    assert winding_number(contour, radius * np.exp(1j * angle)) == 1


BORED = replace(DISC, bore=36.0)

BOLTS = Holes(3, 46.0, 4.0, counterbore=Counterbore(6.0, 4.0))


def bored_wide(counterbore: Counterbore, **others: Any) -> PartSpec:
    return replace(BORED, bolt_circle=replace(BOLTS, counterbore=counterbore), **others)


def bevelling(spec: PartSpec, **chamfers: Chamfer) -> PartSpec:
    return replace(spec, chamfers=Chamfers(**chamfers))


EDGE = "part.chamfers.outline.width"

NO_ROOM = [
    *(
        (Contact.INNER, *row)
        for row in (
            # The inner flank's base circle has a radius of 32 mm; its rise begins at 60 degrees.
            (PartSpec(hub=Hub(64.1, 5.0)), "part.hub.diameter", "comes as near as 3(1.9|2)"),
            (
                PartSpec(bore=20.0, keyway=Keyway(6.0, 2.8), hub=Hub(25.6, 5.0)),
                "part.hub.diameter",
                "more than 26.2937 mm",
            ),
            (PartSpec(mark=Mark(31.5, 2.0, 1.0, angle=1.6)), "part.mark", "clear of the outline"),
            (PartSpec(mark=Mark(90.0, 2.0, 1.0)), "part.mark", "no material"),
            (PartSpec(bore=20.0, mark=Mark(5.0, 2.0, 1.0)), "part.mark", "no material"),
            (PartSpec(bore=20.0, mark=Mark(10.5, 2.0, 1.0)), "part.mark", "clear of the bore"),
            (
                PartSpec(hub=Hub(40.0, 5.0), mark=Mark(20.0, 2.0, 1.0)),
                "part.mark",
                "clear of the hub",
            ),
            (PartSpec(hub=Hub(40.0, 5.0), mark=Mark(15.0, 2.0, 1.0)), "part.mark", "under the hub"),
            (
                PartSpec(bolt_circle=Holes(4, 50.0, 15.0)),
                "part.bolt_circle",
                "bolt hole 2 must lie clear of the outline",
            ),
            (
                PartSpec(hub=Hub(50.0, 5.0), bolt_circle=Holes(4, 50.0, 5.0)),
                "part.bolt_circle",
                "bolt hole 1 must lie clear of the hub",
            ),
            (
                PartSpec(lightening_holes=Holes(12, 30.0, 8.0)),
                "part.lightening_holes",
                "lightening hole 2 must lie clear of the lightening hole 1",
            ),
            (
                PartSpec(bore=10.0, lightening_holes=Holes(1, 6.0, 20.0)),
                "part.lightening_holes",
                "lies around the bore",
            ),
            (
                PartSpec(bolt_circle=Holes(3, 40.0, 6.0), mark=Mark(20.0, 2.0, 1.0)),
                "part.mark",
                "no material",
            ),
            (PartSpec(mark=Mark(1.0, 2.0, 1.0)), "part.mark.radius", "must not reach the cam axis"),
            (
                PartSpec(bore=20.0, keyway=Keyway(20.0, 2.0)),
                "part.keyway.width",
                "narrower than the bore, 20 mm",
            ),
            (bored_wide(Counterbore(6.0, 10.0)), "part.bolt_circle.counterbore.depth", "."),
            (bored_wide(Counterbore(12.0, 4.0)), "part.bolt_circle", "."),  # into the bore
            (
                bored_wide(Counterbore(32.0, 4.0), bore=None),
                "part.bolt_circle",
                ".",
            ),  # into the flank
            # In the hole, and on its floor.
            (bored_wide(Counterbore(6.0, 4.0), mark=Mark(23.0, 1.0, 0.5)), "part.mark", "."),
            (bored_wide(Counterbore(6.0, 4.0), mark=Mark(25.5, 0.5, 0.5)), "part.mark", "."),
            (bevelling(PartSpec(bore=20.0), outline=Chamfer(1.0)), "part.thickness", "."),
            (bevelling(DISC, outline=Chamfer(5.0)), EDGE, "less than 5 mm"),
            (
                bevelling(
                    replace(DISC, bore=40.0), outline=Chamfer(9.9, "upper"), bore=Chamfer(4.0)
                ),
                EDGE,
                "would reach the bore",
            ),
            (
                bevelling(
                    replace(DISC, keyway=Keyway(6.0, 2.8), hub=Hub(29.0, 20.0)), bore=Chamfer(1.0)
                ),
                "part.chamfers.bore.width",
                "would reach the hub",
            ),
            (
                bevelling(replace(DISC, hub=Hub(24.0, 20.0)), hub=Chamfer(1.0), bore=Chamfer(1.0)),
                "part.chamfers.bore.width",
                "would reach the hub, which is 2 mm",
            ),
            (
                bevelling(replace(DISC, hub=Hub(60.0, 3.0)), outline=Chamfer(2.5)),
                EDGE,
                "would reach the hub",
            ),
            (
                bevelling(replace(DISC, thickness=80.0, bore=None), outline=Chamfer(32.0)),
                EDGE,
                "smallest radius of the outline where it goes round material",
            ),
            (bevelling(DISC, hub=Chamfer(1.0)), "part.chamfers.hub", "no such edge"),
        )
    ),
    (Contact.GROOVE, bevelling(DISC, outline=Chamfer(4.0)), EDGE, "less than 4 mm"),
    (
        Contact.GROOVE,
        bevelling(DISC, outline=Chamfer(1.0, "lower")),
        "part.chamfers.outline",
        "lower side",
    ),
]


@pytest.mark.parametrize(("contact", "spec", "key", "message"), NO_ROOM)
def test_what_has_no_room_is_refused_with_its_key(
    contact: Contact, spec: PartSpec, key: str, message: str
) -> None:
    with refused(key, message):
        made(contact, spec)


def test_holes_pass_through_the_hub_that_they_lie_in() -> None:
    holes = Holes(2, 40.0, 5.0)
    within = replace(DISC, hub=Hub(50.0, 6.0, "both"), bolt_circle=holes)
    beside = replace(DISC, hub=Hub(30.0, 6.0, "both"), lightening_holes=holes)
    walls = {name: (z0, z1) for name, z0, z1 in walls_of(made(Contact.INNER, within))}
    assert walls["bolt hole 1"] == walls["bolt hole 2"] == walls["bore"] == (-16.0, 6.0)
    walls = {name: (z0, z1) for name, z0, z1 in walls_of(made(Contact.INNER, beside))}
    assert walls["lightening hole 1"] == (-10.0, 0.0)


def test_holes_beside_a_groove() -> None:
    for diameter in (50.0, 132.0):
        made(Contact.GROOVE, replace(DISC, bolt_circle=Holes(4, diameter, 4.0)))
    with pytest.raises(GeometryError, match="no material"):
        made(Contact.GROOVE, replace(DISC, bolt_circle=Holes(1, 80.0, 4.0, math.pi / 2.0)))


@pytest.mark.parametrize(
    ("angle", "meets"), [(0.0, True), (0.27, True), (0.6, False), (math.pi, False)]
)
def test_a_set_screw_meets_no_hole(angle: float, meets: bool) -> None:
    """A hole of 5 mm 20 mm away, one of 6 mm beside it: they meet within 5.5 mm."""
    screw = SetScrew(6.0, 4.0, angle)
    spec = replace(DISC, hub=Hub(52.0, 8.0), bolt_circle=Holes(1, 40.0, 5.0), set_screw=screw)
    if not meets:
        names = [each.name for each in made(Contact.INNER, spec).boundaries]
        assert names == ["outline", "bore", "bolt hole 1", "hub"]
        return
    with refused("part.set_screw.angle", "would meet the bolt hole 1"):
        made(Contact.INNER, spec)


@given(st.floats(5.0, 60.0), st.floats(0.501, 0.999), st.floats(-6.2, 6.2))
@attack
def test_bore_with_a_flat(diameter: float, share: float, angle: float) -> None:
    contour = flattened(diameter, DShaft(share * diameter, angle))
    radius, away = 0.5 * diameter, (share - 0.5) * diameter
    half = math.acos(away / radius)
    segment = radius**2 * (half - math.sin(half) * math.cos(half))
    assert contour.area == pytest.approx(math.pi * radius**2 - segment, rel=1e-12)
    along = contour.vertices * np.exp(-1j * angle)
    assert along.real == pytest.approx([away, away])
    assert np.abs(along) == pytest.approx([radius, radius])
    part = made(Contact.INNER, PartSpec(bore=diameter, d_shaft=DShaft(share * diameter, angle)))
    assert [each.name for each in part.boundaries] == ["outline", "bore"]


def test_just_enough_room() -> None:
    made(Contact.INNER, PartSpec(hub=Hub(63.9, 5.0)))
    made(Contact.INNER, PartSpec(hub=Hub(63.9, 5.0, "lower"), mark=Mark(30.9, 2.0, 1.0, angle=1.6)))
    # The lower face of a groove cam has no groove.
    groove = replace(DISC, hub=Hub(139.0, 5.0, "lower"))
    made(Contact.GROOVE, groove)
    with pytest.raises(GeometryError, match="inner flank"):
        made(Contact.GROOVE, replace(groove, hub=Hub(139.0, 5.0)))
    # In a ring there is room outside the flank, which comes as far as 63 mm.
    made(Contact.OUTER, replace(DISC, mark=Mark(66.5, 2.0, 1.0)))
    with refused("part.hub", "the roller runs"):
        made(Contact.OUTER, replace(DISC, hub=Hub(40.0, 5.0)))


@given(st.sampled_from(list(FLANKS)), specs())
@attack
def test_random_parts(contact: Contact, spec: PartSpec) -> None:
    """A clear refusal, or layers of boundaries that are nested without touching."""
    part = made_or_refused(contact, spec)
    if part is None:
        return
    for layer in part.layers:
        areas = [polygon_of(each) for each in layer.boundaries]
        for k, one in enumerate(areas):
            for other in areas[:k]:
                assert not shapely.intersects(one.exterior, other.exterior)
        for each, own in zip(layer.boundaries, areas, strict=True):
            start = shapely.Point(own.exterior.coords[0])
            around = sum(other.contains(start) for other in areas if other is not own)
            assert each.hole == (around % 2 == 1)
    above = [layer for layer in part.layers if part.outermost not in layer.boundaries]
    for hub in above:
        # Nothing that is sunk in the face lies below.
        covered = polygon_of(hub.boundaries[0])
        for boundary in part.boundaries:
            if boundary.hole and boundary not in hub.boundaries:
                assert hub.z0 < 0.0 or not covered.intersects(polygon_of(boundary).exterior)


def test_counterbores_are_a_layer_of_their_own() -> None:
    part = made(Contact.INNER, replace(DISC, bore=12.0, bolt_circle=BOLTS))
    assert [(layer.name, layer.z0, layer.z1) for layer in part.layers] == [
        ("disc", -10.0, -4.0), ("counterbore", -4.0, 0.0),
    ]  # fmt: skip
    assert ("counterbore 2", -4.0, 0.0) in walls_of(part)
    assert ("bolt hole 2", -10.0, -4.0) in walls_of(part)
    assert part.levels[1].name == "floor of the counterbore"
    plain = made(Contact.INNER, replace(DISC, bore=12.0, bolt_circle=Holes(3, 46.0, 4.0)))
    less = Solid.from_part(plain).volume - Solid.from_part(part).volume
    assert less == pytest.approx(3.0 * math.pi * (3.0**2 - 2.0**2) * 4.0, rel=1e-9)


def test_counterbores_in_a_hub_begin_on_its_face() -> None:
    spec = replace(DISC, bore=12.0, hub=Hub(28.0, 6.0, "both"))
    bolts = Holes(3, 20.5, 2.0, counterbore=Counterbore(4.0, 21.0))
    part = made(Contact.INNER, replace(spec, bolt_circle=bolts))
    assert ("counterbore 1", -15.0, 6.0) in walls_of(part)
    assert ("bolt hole 1", -16.0, -15.0) in walls_of(part)


def test_a_counterbore_is_wider_than_its_hole() -> None:
    with refused("part.bolt_circle.counterbore.diameter", "above 4"):
        Holes(3, 46.0, 4.0, counterbore=Counterbore(4.0, 1.0))


assert isinstance(PITCH.follower, TranslatingRoller)
OTHER: Final = PitchCurve(PITCH.motion, return_on_carriage(PITCH.follower, 100.0), PITCH.rotation)
"""From 45 to 60 mm, its flank from 37 to 52 mm."""

PATHS: Final = (whole(WorkingCurve(PITCH, -ROLLER)), whole(WorkingCurve(OTHER, -ROLLER)))

PLAIN: Final = PartSpec(thickness=10.0, bore=20.0, pair=Pair(gap=7.0, spacer=36.0))


def paired(spec: PartSpec) -> Part:
    return build_pair(PATHS, spec, 0.01)


def test_two_discs_on_a_spacer_share_their_bore() -> None:
    part = paired(PLAIN)
    assert walls_of(part) == [
        ("return outline", -27.0, -17.0),
        ("bore", -27.0, 0.0),
        ("spacer", -17.0, -10.0),
        ("outline", -10.0, 0.0),
    ]
    assert [each.name for each in part.layers] == ["return disc", "spacer", "disc"]
    assert [each.name for each in part.levels] == [
        "lower face", "upper face of the return disc", "lower face of the disc", "upper face",
    ]  # fmt: skip


def test_either_disc_may_be_above() -> None:
    assert PLAIN.pair is not None
    part = paired(replace(PLAIN, pair=replace(PLAIN.pair, upper="return")))
    assert [each.name for each in part.layers] == ["disc", "spacer", "return disc"]
    assert [each.name for each in part.levels] == [
        "lower face", "upper face of the disc", "lower face of the return disc", "upper face",
    ]  # fmt: skip
    volume = Solid.from_part(part).volume
    assert volume == pytest.approx(Solid.from_part(paired(PLAIN)).volume, rel=1e-14)


@pytest.mark.parametrize("side", ["upper", "lower", "both"])
def test_the_hub_stands_on_the_outer_faces(side: str) -> None:
    """It is the pair's: none stands in the gap. The set screw is where the first hub is."""
    screw = SetScrew(4.0, 3.0)
    part = paired(replace(PLAIN, hub=Hub(30.0, 6.0, side), set_screw=screw))
    low, high = (-33.0 if side != "upper" else -27.0), (6.0 if side != "lower" else 0.0)
    assert (part.layers[0].z0, part.layers[-1].z1) == (low, high)
    assert ("bore", low, high) in walls_of(part)
    names = {"upper": {"hub"}, "lower": {"lower hub"}, "both": {"hub", "lower hub"}}[side]
    assert {name for name, *_ in walls_of(part) if "hub" in name} == names


def test_volume_and_moments_are_those_of_its_bodies() -> None:
    """Of the discs alone, and of spacer and hub as rings around bore and holes."""
    spec = replace(
        PLAIN, keyway=Keyway(6.0, 2.8, 0.7), mark=Mark(25.0, 2.0, 0.5), hub=Hub(28.0, 6.0, "lower"),
        bolt_circle=Holes(3, 31.0, 2.0),
    )  # fmt: skip
    discs = [
        Solid.from_part(build_part(Contact.INNER, path, path, spec.alone(name), 0.01))
        for name, path in zip(DISCS, PATHS, strict=True)
    ]
    pair = Solid.from_part(paired(spec))
    bore = bore_outline(20.0, spec.keyway)
    holes = [Contour.circle(1.0, middle) for middle in Holes(3, 31.0, 2.0).middles]
    spacer = _ring(18.0, [bore, *holes])
    hub = _ring(14.0, [bore])
    bodies = [  # volume, axial moment, height of the middle
        (discs[0].volume, discs[0].axial, discs[0].centre[2]),
        (discs[1].volume, discs[1].axial, discs[1].centre[2] - 17.0),
        (7.0 * spacer[0], 7.0 * spacer[1], -13.5),
        (6.0 * hub[0], 6.0 * hub[1], -30.0),
    ]
    assert pair.volume == pytest.approx(math.fsum(each[0] for each in bodies), rel=1e-12)
    assert pair.axial == pytest.approx(math.fsum(each[1] for each in bodies), rel=1e-12)
    first = math.fsum(volume * z for volume, _, z in bodies)
    assert pair.centre[2] == pytest.approx(first / pair.volume, rel=1e-12)


def _ring(radius: float, holes: list[Contour]) -> tuple[float, float]:
    """Area and polar moment about the cam axis of a disc with holes."""
    area, polar = math.pi * radius**2, 0.5 * math.pi * radius**4
    for each in holes:
        boundary = ExactBoundary("hole", hole=True, exact=each)
        area -= boundary.moments(1e-10).area
        polar -= boundary.second_moments(1e-10).polar
    return area, polar


def test_bolts_go_in_from_above_and_texts_can_be_read() -> None:
    """Only the upper disc has counterbores and texts, alone and in the pair."""
    bolts = Holes(2, 29.0, 2.5, counterbore=Counterbore(4.0, 3.0))
    spec = replace(PLAIN, bolt_circle=bolts)
    for upper, other in (DISCS, DISCS[::-1]):
        pair = replace(spec, pair=Pair(7.0, 36.0, upper))
        walls = walls_of(paired(pair))
        assert ("counterbore 1", -3.0, 0.0) in walls
        assert ("bolt hole 1", -27.0, -3.0) in walls
        kept = [pair.alone(each).bolt_circle for each in (upper, other)]
        assert kept == [bolts, replace(bolts, counterbore=None)]
    written = replace(PLAIN, engraving=(Engraving("I", 3.0, 0.5, radius=24.0),))
    texts = [(name, z0, z1) for name, z0, z1 in walls_of(paired(written)) if "engraving" in name]
    assert [heights for _, *heights in texts] == [[-0.5, 0.0]]


@pytest.mark.parametrize(
    ("changes", "spacer", "key", "message"),
    [
        ({}, 63.99, "spacer", r"31\.995 mm .* of the main disc comes as near as 32 mm at cam"),
        ({"bolt_circle": Holes(2, 36.0, 3.0)}, 36.0, "spacer", "clear of the bolt hole 1"),
        ({"keyway": Keyway(6.0, 9.0)}, 36.0, "spacer", "clear of the bore, which it touches"),
        ({"bore": None, "bolt_circle": Holes(1, 4.0, 20.0)}, 6.0, "spacer", "around the spacer"),
        ({"mark": Mark(14.0, 2.0, 0.5)}, 36.0, "spacer", "the mark ends under the spacer"),
        ({"mark": Mark(18.0, 2.0, 0.5)}, 36.0, "spacer", "clear of the mark, which it touches"),
        ({"mark": Mark(35.0, 6.0, 0.5, angle=1.2)}, 36.0, "mark", "main disc: the mark must lie"),
    ],
)  # fmt: skip
def test_what_has_no_room(changes: dict[str, Any], spacer: float, key: str, message: str) -> None:
    spec = replace(PLAIN, pair=Pair(7.0, spacer), **changes)
    with refused(f"part.{'pair.' if key == 'spacer' else ''}{key}", message):
        paired(spec)


@settings(max_examples=examples(20, long=200))
@given(
    st.floats(20.5, 70.0), st.floats(0.1, 40.0), st.floats(10.0, 60.0), st.floats(1.0, 12.0),
    st.sampled_from(["upper", "lower", "both"]), st.sampled_from(["main", "return"]),
)  # fmt: skip
def test_it_is_refused_or_its_sections_are_the_discs(
    spacer: float, gap: float, circle: float, hole: float, side: str, upper: str
) -> None:
    """Areas of the layers are those of discs, spacer and hub less what goes through them."""
    spec = replace(
        PLAIN, pair=Pair(gap, spacer, upper), hub=Hub(28.0, 5.0, side),
        bolt_circle=Holes(3, circle, hole),
    )  # fmt: skip
    try:
        part = paired(spec)
    except GeometryError as error:
        if not error.key.startswith("part."):
            raise
        return
    heights = np.array([(each.z0, each.z1) for each in part.layers])
    assert np.all(heights[:-1, 1] == heights[1:, 0])
    assert part.thickness == pytest.approx(
        20.0 + gap + (10.0 if side == "both" else 5.0), rel=1e-12
    )
    inside = 0.5 * (circle + hole) < 0.5 * spacer
    (between,) = (each for each in part.layers if each.name == "spacer")
    assert len(between.boundaries) == (5 if inside else 2)
    names = [each.name for each in part.boundaries]
    assert len(set(names)) == len(names)


def test_a_pair_has_chamfers_as_a_whole() -> None:
    """Along both flanks, at the ends of the bore, and on the hub; discs alone have their share."""
    half = Chamfer(0.5)
    edges = Chamfers(outline=half, bore=half, hub=Chamfer(1.0))
    spec = replace(PLAIN, hub=Hub(34.0, 8.0, "lower"), chamfers=edges)
    part = paired(spec)
    assert sorted((each.boundary.name, each.z) for each in part.bevels) == [
        ("bore", -35.0), ("bore", 0.0), ("lower hub", -35.0), ("outline", -10.0), ("outline", 0.0),
        ("return outline", -27.0), ("return outline", -17.0),
    ]  # fmt: skip
    assert spec.alone("main").chamfers == Chamfers(half, bore=Chamfer(0.5, "upper"))
    assert spec.alone("return").chamfers == Chamfers(half)
    sharp = Solid.from_part(paired(replace(spec, chamfers=None))).volume
    bore = 2.0 * math.pi * (0.25 * 10.0 + 0.125 / 3.0)  # twice the ring of a triangle
    hub = math.pi * (17.0 - 1.0 / 3.0)
    lengths = [path_length(path) for path in PATHS]
    # Of a convex edge: half the square of the width along it, less a part of a cone.
    flanks = 2.0 * sum(0.125 * length - math.pi * 0.125 / 3.0 for length in lengths)
    assert sharp - Solid.from_part(part).volume == pytest.approx(bore + hub + flanks, rel=1e-3)


def path_length(path: Path) -> float:
    return CurveBoundary("outline", False, path).polyline(1e-3, "fast").contour.length


# -- bevels ----------------------------------------------------------------------------------------
# Chamfers of parts: closed forms of their bodies, which edges have one, and what has no room.


def edged(contact: Contact, spec: PartSpec, **chamfers: Chamfer) -> Part:
    return made(contact, bevelling(spec, **chamfers))


def found(part: Part) -> list[tuple[str, float, float]]:
    return [(each.boundary.name, each.z, each.foot) for each in part.bevels]


def sizes(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda size: round(size, 3))


@given(sizes(25.0, 60.0), sizes(0.1, 4.9), sizes(0.1, 4.9), sizes(0.0, 5.0))
@attack
def test_a_round_disc_is_a_cylinder_between_frustums(
    radius: float, of_rim: float, of_bore: float, aside: float
) -> None:
    """Volume, centre and moments of a frustum of cone are those of its circles over its height."""
    bore = circle("bore", 8.0, aside + 0j, hole=True)
    part = Part((Layer(-10.0, 0.0, (circle("outline", radius), bore)),))
    part = bevelled(part, Chamfers(outline=Chamfer(of_rim), bore=Chamfer(of_bore, "upper")), 0.01)
    body = Solid.from_part(part)
    around = [_frustum(radius, radius - of_rim, -of_rim), _cylinder(radius, of_rim - 10.0,
              -of_rim), _frustum(radius - of_rim, radius, -10.0, of_rim)]  # fmt: skip
    within = [_cylinder(8.0, -10.0, -of_bore), _frustum(8.0, 8.0 + of_bore, -of_bore)]
    volume = sum(each[0] for each in around) - sum(each[0] for each in within)
    height = sum(each[1] for each in around) - sum(each[1] for each in within)
    polar = sum(each[2] for each in around) - sum(
        each[2] + each[0] * aside**2 for each in within
    )  # fmt: skip
    assert body.volume == pytest.approx(volume, rel=1e-12)
    assert (body.centre[2] * volume, body.axial) == pytest.approx((height, polar), rel=1e-11)
    moments = disc_moments(part, 1.0, 1e-10)
    assert moments.area == pytest.approx(volume, rel=1e-12)
    assert moments.first == pytest.approx(-aside * sum(each[0] for each in within), abs=1e-8)


def _cylinder(radius: float, z0: float, z1: float) -> tuple[float, float, float]:
    """Volume, its first moment about z = 0, and its moment of inertia about the axis."""
    volume = math.pi * radius**2 * (z1 - z0)
    return volume, 0.5 * (z0 + z1) * volume, 0.5 * radius**2 * volume


def _frustum(
    lower: float, upper: float, z0: float, height: float | None = None
) -> tuple[float, float, float]:
    """The same of a cone between two radii from `z0` up, of 45 degrees."""
    high = abs(upper - lower) if height is None else height
    volume = math.pi * high * (lower**2 + lower * upper + upper**2) / 3.0
    first = math.pi * high**2 * (lower**2 + 2.0 * lower * upper + 3.0 * upper**2) / 12.0
    polar = 0.1 * math.pi * high * (upper**5 - lower**5) / (upper - lower)
    return volume, z0 * volume + first, polar


def test_edges_between_faces_have_chamfers_and_feet_have_none() -> None:
    spec = replace(DISC, bore=12.0, hub=Hub(30.0, 6.0, "both"))
    bolts = Holes(2, 46.0, 4.0, counterbore=Counterbore(6.0, 4.0))
    half, one = Chamfer(0.5), Chamfer(1.0, "upper")
    part = edged(Contact.INNER, replace(spec, bolt_circle=bolts),
                 outline=one, bore=half, hub=half, bolt_circle=half)  # fmt: skip
    assert sorted(found(part)) == sorted([
        ("outline", 0.0, -1.0),
        ("bore", -16.0, -15.5), ("bore", 6.0, 5.5),
        ("lower hub", -16.0, -15.5), ("hub", 6.0, 5.5),
        *((f"counterbore {k}", 0.0, -0.5) for k in (1, 2)),
        *((f"bolt hole {k}", -10.0, -9.5) for k in (1, 2)),
    ])  # fmt: skip
    names = [each.name for each in part.levels[-2].boundaries]
    assert {"chamfer of the outline", "hub", "chamfer of the counterbore 1"} <= set(names)
    assert [each.boundary for each in part_edges(part)] == [
        each.boundary for each in part_edges(part.sharp)
    ]
    assert part.lowered().bevels == part.turned_over().bevels == ()


def test_flanks_of_a_groove_have_upper_edges_only() -> None:
    part = edged(Contact.GROOVE, DISC, outline=Chamfer(0.5), rim=Chamfer(1.0, "lower"))
    assert sorted(found(part)) == [
        ("inner flank", 0.0, -0.5), ("outer flank", 0.0, -0.5), ("rim", -10.0, -9.0),
    ]  # fmt: skip


@pytest.mark.parametrize("hole", [False, True])
def test_an_edge_is_the_exact_parallel(hole: bool) -> None:
    part = edged(Contact.OUTER if hole else Contact.INNER, DISC, outline=Chamfer(2.0))
    (edge,) = {each.edge.name: each.edge for each in part.bevels}.values()
    (flank,) = (each for each in part.boundaries if each.name == "outline")
    fits = [each.polyline(1e-4, "fast").contour for each in (flank, edge)]
    # Area and length of parallels: A + L d + pi d^2, L + 2 pi d.
    sign = 1.0 if hole else -1.0
    areas = [each.moments(1e-12).area for each in (flank, edge)]
    grown = areas[0] + sign * 2.0 * fits[0].length + 4.0 * math.pi
    assert (areas[1], fits[1].length) == pytest.approx(
        (grown, fits[0].length + sign * 4.0 * math.pi), rel=1e-6
    )


def test_chamfers_at_different_heights_do_not_meet() -> None:
    """A hole 1.5 mm beside the bore, each with a chamfer of 1 mm."""
    spec = replace(DISC, bolt_circle=Holes(1, 27.0, 4.0))
    part = edged(Contact.INNER, spec, bore=Chamfer(1.0, "upper"), bolt_circle=Chamfer(1.0, "lower"))
    sharp = edged(Contact.INNER, spec)
    # By Pappus' theorem: a triangle of 1 mm by 1 mm about each axis, its centroid a third outside.
    cut = math.pi * (10.0 + 1.0 / 3.0) + math.pi * (2.0 + 1.0 / 3.0)
    assert Solid.from_part(part).volume == pytest.approx(
        Solid.from_part(sharp).volume - cut, rel=1e-12
    )
    with pytest.raises(GeometryError, match=r"would reach the bolt hole 1, which is 1\.5 mm"):
        edged(Contact.INNER, spec, bore=Chamfer(1.0), bolt_circle=Chamfer(1.0, "lower"))


def keyed_sections(radius: float, p: float, bottom: float, by: float) -> float:
    """Area within the parallel of a bore with keyway, as circle, rectangle, less their overlap."""
    outer, half = radius + by, p + by
    flat = math.sqrt(outer**2 - half**2)
    segment = outer**2 * math.asin(half / outer) - half * flat
    return math.pi * outer**2 - segment + 2.0 * half * (bottom + by - flat)


@pytest.mark.parametrize("width", [0.3, 1.0, 4.9])
@pytest.mark.parametrize("keyway", [Keyway(6.0, 2.8), Keyway(19.0, 0.5, 1.0), Keyway(0.5, 3.0)])
def test_a_chamfer_goes_along_a_keyway(width: float, keyway: Keyway) -> None:
    """Volume by closed areas of sections and adaptive quadrature, to its rounding."""
    spec = replace(DISC, keyway=keyway)
    part = edged(Contact.INNER, spec, bore=Chamfer(width, "upper"))
    sizes_ = (10.0, 0.5 * keyway.width, 10.0 + keyway.depth)
    cut, _ = quad(lambda by: keyed_sections(*sizes_, by), 0.0, width, epsabs=0.0, epsrel=1e-13)
    wanted = cut - width * keyed_sections(*sizes_, 0.0)
    removed = Solid.from_part(part.sharp).volume - Solid.from_part(part).volume
    assert removed == pytest.approx(wanted, abs=1e-11 * Solid.from_part(part).volume)


def test_a_chamfer_goes_along_a_flat() -> None:
    """Its edge is the bore of a larger diameter, farther across by the chamfer on both sides."""
    part = edged(Contact.INNER, replace(DISC, d_shaft=DShaft(17.0, 1.0)), bore=Chamfer(1.0))
    edge = part.bevels[0].edge
    larger = made(Contact.INNER, replace(DISC, bore=22.0, d_shaft=DShaft(19.0, 1.0)))
    (bore,) = (each for each in larger.boundaries if each.name == "bore")
    assert edge.deviation(bore.arcs(1e-3).contour) <= 1e-12
    assert edge.moments(1e-10).area == pytest.approx(bore.moments(1e-10).area, rel=1e-14)


def test_a_chamfer_around_a_pin_is_narrower_than_it() -> None:
    """At its radius the edge would be a point."""
    rim, pin = circle("rim", 40.0), circle("hub", 3.0)
    part = Part((Layer(-10.0, 0.0, (rim,)), Layer(0.0, 20.0, (pin,), "hub")))
    inside = bevelled(part, Chamfers(hub=Chamfer(math.nextafter(3.0, 0.0))), 0.01)
    assert [each.boundary.name for each in inside.bevels] == ["hub"]
    with pytest.raises(GeometryError, match="less than the radius of the hub, 3 mm") as caught:
        bevelled(part, Chamfers(hub=Chamfer(3.0)), 0.01)
    assert (caught.value.key, caught.value.value) == ("part.chamfers.hub.width", "3")


def test_a_chamfer_is_at_the_end_of_a_wall() -> None:
    outline = ExactBoundary("outline", hole=False, exact=Contour.circle(20.0))
    layers = (Layer(-10.0, 0.0, (outline,)),)
    edge = outline.inset(1.0, "edge")
    with pytest.raises(GeometryError, match="at an end of a wall"):
        Part(layers, (Bevel(outline, edge, 1.0, 1.0, -1.0, upper=True),))
    both = [
        Bevel(outline, edge, 5.0, 5.0, z, upper=upper) for z, upper in ((0.0, True), (-10.0, False))
    ]
    with pytest.raises(GeometryError, match="leave some of a wall"):
        Part(layers, tuple(both))


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("chamfers = { rim = { width = 1 } }", "needs .part. rim"),
        ("chamfers = { hub = { width = 1 } }", "needs .part. hub"),
        ("chamfers = { outline = { width = 1, edges = 'top' } }", "edges"),
        ("chamfers = { outline = 1 }", "outline = { width = 0.5 }|width = 0.5"),
    ],
)
def test_scenes_name_the_edges(keys: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        loaded(PLATE, ("[output]\n", f"{keys}\n[output]\n"))
