"""Clearance, scale and foot of parts: where each face lies afterwards."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.compensation import compensated, with_clearance
from camgeo.part.mass import solid
from camgeo.part.part import Part
from camgeo.part.printing import Foot, PrintSpec, Shrinkage
from camgeo.part.spec import Chamfer, Chamfers, DShaft, Holes, Hub, Keyway, PartSpec
from tests.part.parts import DISC, FLANKS, made, made_or_refused, refused, specs
from tests.strategies import attack

KEYED = replace(DISC, keyway=Keyway(6.0, 2.8, 0.4))


def _bore(part: Part) -> ExactBoundary:
    (found,) = (each for each in part.boundaries if each.name == "bore")
    assert isinstance(found, ExactBoundary)
    return found


def test_clearance_of_bore_and_keyway() -> None:
    """Half of it on each side; the bottom of the keyway moves with the key's clearance alone."""
    spec = with_clearance(KEYED, PrintSpec(bore_clearance=0.3, key_clearance=0.2))
    assert spec.bore == pytest.approx(20.3)
    assert spec.keyway is not None
    assert spec.keyway.width == pytest.approx(6.2)
    vertices = _bore(made(Contact.INNER, spec)).exact.vertices * np.exp(-0.4j)
    assert np.max(vertices.real) == pytest.approx(10.0 + 2.8 + 0.1, abs=1e-12)
    assert np.max(vertices.imag) == pytest.approx(3.1, abs=1e-12)
    assert np.min(np.abs(vertices)) == pytest.approx(10.15, abs=1e-12)
    only_bore = with_clearance(KEYED, PrintSpec(bore_clearance=0.3))
    assert only_bore.keyway is not None
    assert only_bore.keyway.width == 6.0
    assert 0.5 * 20.3 + only_bore.keyway.depth == pytest.approx(12.8, abs=1e-12)


def test_clearance_of_a_flat() -> None:
    flat = replace(DISC, d_shaft=DShaft(17.0))
    spec = with_clearance(flat, PrintSpec(bore_clearance=0.4, key_clearance=0.2))
    assert spec.d_shaft is not None
    radius = 0.5 * (spec.bore or 0.0)
    assert radius == pytest.approx(10.2)
    assert spec.d_shaft.across - radius == pytest.approx(7.0 + 0.1, abs=1e-12)


def test_no_clearance_leaves_the_part() -> None:
    assert with_clearance(KEYED, PrintSpec(elephant_foot=Foot(0.1, 0.2))) is KEYED
    assert with_clearance(PartSpec(), PrintSpec(bore_clearance=0.3)) == PartSpec()
    part = made(Contact.INNER, KEYED)
    assert compensated(part, PrintSpec(bore_clearance=0.3)) is part


def test_a_clearance_that_eats_the_keyway() -> None:
    with refused("print.bore_clearance", "no room for it"):
        with_clearance(KEYED, PrintSpec(bore_clearance=6.0))
    tight = replace(KEYED, hub=Hub(20.1, 5.0))
    with refused("print.bore_clearance", "no room for it"):
        with_clearance(tight, PrintSpec(bore_clearance=0.3))


def test_the_foot_is_drawn_in_step_by_step() -> None:
    part = made(Contact.INNER, replace(KEYED, bolt_circle=Holes(3, 46.0, 5.0)))
    found = compensated(part, PrintSpec(elephant_foot=Foot(0.3, 0.6, 3)))
    assert [(each.name, each.z0) for each in found.layers] == [
        ("foot", -10.0),
        ("foot", pytest.approx(-9.8)),
        ("foot", pytest.approx(-9.6)),
        ("disc", pytest.approx(-9.4)),
    ]
    for number, inset in enumerate((0.3, 0.2, 0.1, 0.0)):
        outline, bore, hole, *_ = found.layers[number].boundaries
        assert outline.farthest()[0] == pytest.approx(47.0 - inset, abs=1e-9)
        assert outline.nearest() == pytest.approx(32.0 - inset, abs=1e-9)
        assert bore.nearest() == pytest.approx(10.0 + inset, abs=1e-9)
        assert bore.farthest()[0] == pytest.approx(
            abs(complex(12.8 + inset, 3.0 + inset)), abs=1e-9
        )
        assert hole.farthest()[0] == pytest.approx(23.0 + 2.5 + inset, abs=1e-9)
    assert found.layers[-1].boundaries == part.layers[0].boundaries
    assert [each.name for each in found.levels][1:] == [
        "floor of the foot", "floor of the foot", "lower face of the disc", "upper face",
    ]  # fmt: skip


def test_a_foot_of_a_lower_hub() -> None:
    """Only what stands on the bed is drawn in."""
    part = made(Contact.GROOVE, replace(DISC, hub=Hub(40.0, 6.0, "lower")))
    found = compensated(part, PrintSpec(elephant_foot=Foot(0.2, 1.0)))
    foot = found.layers[0]
    assert [each.name for each in foot.boundaries] == ["lower hub at step 1", "bore at step 1"]
    assert foot.boundaries[0].farthest()[0] == pytest.approx(19.8)
    assert found.layers[2:] == part.layers[1:]


@pytest.mark.parametrize(
    ("foot", "key"),
    [(Foot(0.2, 10.0), "height"), (Foot(11.0, 0.2), "inset"), (Foot(40.0, 0.2), "inset")],
)
def test_a_foot_without_room(foot: Foot, key: str) -> None:
    with refused(f"print.elephant_foot.{key}"):
        compensated(made(Contact.INNER, DISC), PrintSpec(elephant_foot=foot))


def test_holes_that_a_foot_would_join() -> None:
    part = made(Contact.INNER, replace(DISC, bolt_circle=Holes(2, 30.0, 9.0)))
    for inset, fits in ((0.2, True), (0.26, False)):  # 0.5 mm lie between hole and bore
        spec = PrintSpec(elephant_foot=Foot(inset, 0.2))
        if fits:
            assert compensated(part, spec).layers[0].name == "foot"
            continue
        with pytest.raises(GeometryError, match="bore and bolt hole 1 would touch"):
            compensated(part, spec)


@given(st.sampled_from(list(FLANKS)), specs(), st.floats(-9.0, 19.0), st.floats(-9.0, 19.0))
@attack
def test_scaling_multiplies_volume_and_moments(
    contact: Contact, spec: PartSpec, xy: float, z: float
) -> None:
    part = made_or_refused(contact, spec)
    assume(part is not None and part.thickness)
    assert part is not None
    shrinkage = Shrinkage(xy, z)
    found = compensated(part, PrintSpec(shrinkage=shrinkage))
    a, b = shrinkage.scale_xy, shrinkage.scale_z
    before, after = solid(part), solid(found)
    assert after.volume == pytest.approx(before.volume * a**2 * b, rel=1e-9)
    assert after.axial == pytest.approx(before.axial * a**4 * b, rel=1e-9)
    # Shrunk again by what was stated, it is the part.
    assert found.thickness * (1.0 - 0.01 * z) == pytest.approx(part.thickness, rel=1e-12)
    reach = found.outermost.farthest()[0] * (1.0 - 0.01 * xy)
    assert reach == pytest.approx(part.outermost.farthest()[0], rel=1e-12)


def test_all_at_once() -> None:
    """The foot is counted in millimetres of the file, whatever the scale."""
    spec = PrintSpec(0.3, 0.2, Foot(0.25, 0.4), Shrinkage(1.0, 2.0))
    found = compensated(made(Contact.INNER, with_clearance(KEYED, spec)), spec)
    foot, disc = found.layers
    assert foot.z1 - foot.z0 == pytest.approx(0.4)
    assert disc.z1 - foot.z0 == pytest.approx(10.0 / 0.98)
    assert disc.boundaries[0].farthest()[0] == pytest.approx(47.0 / 0.99)
    assert foot.boundaries[0].farthest()[0] == pytest.approx(47.0 / 0.99 - 0.25)
    assert disc.boundaries[1].nearest() == pytest.approx(10.15 / 0.99)
    assert foot.boundaries[1].nearest() == pytest.approx(10.15 / 0.99 + 0.25)
    assert math.isclose(disc.z1, 0.0)


def test_chamfers_are_scaled_with_the_part() -> None:
    """Also where they are no longer of 45 degrees; upper ones stay above a foot."""
    edges = Chamfers(outline=Chamfer(1.0, "upper"), bore=Chamfer(0.5, "upper"))
    part = made(Contact.INNER, replace(DISC, chamfers=edges))
    spec = PrintSpec(shrinkage=Shrinkage(xy=2.0, z=1.0))
    stretched, xy, z = compensated(part, spec), spec.scale_xy, spec.scale_z
    assert stretched.thickness == pytest.approx(10.0 * z)
    assert solid(stretched).volume == pytest.approx(xy**2 * z * solid(part).volume, rel=1e-12)
    footed = compensated(part, PrintSpec(elephant_foot=Foot(0.3, 0.2)))
    assert footed.bevels == part.bevels


def test_a_foot_is_not_drawn_in_where_there_are_chamfers() -> None:
    part = made(Contact.INNER, replace(DISC, chamfers=Chamfers(outline=Chamfer(1.0))))
    with refused("print.elephant_foot", "edges of the lowest face have chamfers"):
        compensated(part, PrintSpec(elephant_foot=Foot(0.3, 0.2)))
