"""Parts assembled from features: hub, timing mark, and what has no room."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import winding_number
from camgeo.part.assembly import flattened, mark_outline
from camgeo.part.mass import solid
from camgeo.part.spec import Counterbore, DShaft, Holes, Hub, Keyway, Mark, PartSpec, SetScrew
from tests.part.parts import (
    DISC,
    FLANKS,
    made,
    made_or_refused,
    polygon_of,
    refused,
    specs,
    walls_of,
)
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
    with refused("part", r"0\.02 mm has no layer of 0\.015 mm"):
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


@pytest.mark.parametrize(
    ("spec", "key", "message"),
    [
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
        (PartSpec(hub=Hub(40.0, 5.0), mark=Mark(20.0, 2.0, 1.0)), "part.mark", "clear of the hub"),
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
    ],
)
def test_no_room(spec: PartSpec, key: str, message: str) -> None:
    with refused(key, message):
        made(Contact.INNER, spec)


def test_holes_pass_through_the_hub_that_they_lie_in() -> None:
    holes = Holes(2, 40.0, 5.0)
    within = replace(DISC, hub=Hub(50.0, 6.0, "both"), bolt_circle=holes)
    beside = replace(DISC, hub=Hub(30.0, 6.0, "both"), lightening_holes=holes)
    walls = {name: (z0, z1) for name, z0, z1 in walls_of(made(Contact.INNER, within))}
    assert walls["bolt hole 1"] == walls["bolt hole 2"] == walls["bore"] == (-16.0, 6.0)
    walls = {name: (z0, z1) for name, z0, z1 in walls_of(made(Contact.INNER, beside))}
    assert walls["lightening hole 1"] == (-10.0, 0.0)


def test_holes_beside_a_groove() -> None:
    for circle in (50.0, 132.0):
        made(Contact.GROOVE, replace(DISC, bolt_circle=Holes(4, circle, 4.0)))
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
    with refused("part.set_screw.angle", "meets the bolt hole 1"):
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


BOLTS = Holes(3, 46.0, 4.0, counterbore=Counterbore(6.0, 4.0))


def test_counterbores_are_a_layer_of_their_own() -> None:
    part = made(Contact.INNER, replace(DISC, bore=12.0, bolt_circle=BOLTS))
    assert [(layer.name, layer.z0, layer.z1) for layer in part.layers] == [
        ("disc", -10.0, -4.0), ("counterbore", -4.0, 0.0),
    ]  # fmt: skip
    assert ("counterbore 2", -4.0, 0.0) in walls_of(part)
    assert ("bolt hole 2", -10.0, -4.0) in walls_of(part)
    assert part.levels[1].name == "floor of the counterbore"
    plain = made(Contact.INNER, replace(DISC, bore=12.0, bolt_circle=Holes(3, 46.0, 4.0)))
    less = solid(plain).volume - solid(part).volume
    assert less == pytest.approx(3.0 * math.pi * (3.0**2 - 2.0**2) * 4.0, rel=1e-9)


def test_counterbores_in_a_hub_begin_on_its_face() -> None:
    spec = replace(DISC, bore=12.0, hub=Hub(28.0, 6.0, "both"))
    bolts = Holes(3, 20.5, 2.0, counterbore=Counterbore(4.0, 21.0))
    part = made(Contact.INNER, replace(spec, bolt_circle=bolts))
    assert ("counterbore 1", -15.0, 6.0) in walls_of(part)
    assert ("bolt hole 1", -16.0, -15.0) in walls_of(part)


@pytest.mark.parametrize(
    ("counterbore", "others", "key"),
    [
        (Counterbore(6.0, 10.0), {}, "part.bolt_circle.counterbore.depth"),
        (Counterbore(12.0, 4.0), {}, "part.bolt_circle"),  # into the bore
        (Counterbore(32.0, 4.0), {"bore": None}, "part.bolt_circle"),  # into the flank
        (Counterbore(6.0, 4.0), {"mark": Mark(23.0, 1.0, 0.5)}, "part.mark"),  # in the hole
        (Counterbore(6.0, 4.0), {"mark": Mark(25.5, 0.5, 0.5)}, "part.mark"),  # on its floor
    ],
)
def test_counterbores_without_room_are_refused(
    counterbore: Counterbore, others: dict[str, object], key: str
) -> None:
    spec = replace(DISC, bore=36.0, bolt_circle=replace(BOLTS, counterbore=counterbore))
    with refused(key):
        made(Contact.INNER, replace(spec, **others))  # type: ignore[arg-type]  # of several types


def test_a_counterbore_is_wider_than_its_hole() -> None:
    with refused("part.bolt_circle.counterbore.diameter", "above 4"):
        Holes(3, 46.0, 4.0, counterbore=Counterbore(4.0, 1.0))
