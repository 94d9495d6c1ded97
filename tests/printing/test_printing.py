"""What is printed: clearance, scale, foot and parallels of parts, test rings and rollers, and what
a nozzle cannot make.
"""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.cam.cam import Contact
from camgeo.check.finding import Finding
from camgeo.design.plate import ring_part, roller_part
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.parallel import parallel
from camgeo.numeric.checked import instance_from_table
from camgeo.part.assembly import bore_outline, flattened, mark_outline
from camgeo.part.boundaries import CurveBoundary, ExactBoundary, LetterBoundary
from camgeo.part.compensation import (
    Foot,
    PrintSpec,
    ScaledBoundary,
    Shrinkage,
    compensate_part,
    inset_boundary,
    scaled,
    scaled_contour,
    scaled_splines,
)
from camgeo.part.mass import Solid
from camgeo.part.nozzle import RADIUS, STROKE, WALL, nozzle_findings, sunk
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import (
    Chamfer,
    Chamfers,
    DShaft,
    Engraving,
    Holes,
    Hub,
    Keyway,
    Mark,
    PartSpec,
)
from tests.contour.cams import SCENES
from tests.export.stub_product import CircleBoundary
from tests.long_form import examples
from tests.part.parts import DISC, FLANKS, INNER, made, made_or_refused, refused, specs
from tests.strategies import attack

# Where each face lies afterwards ------------------------------------------------------------------


KEYED = replace(DISC, keyway=Keyway(6.0, 2.8, 0.4))


def _bore(part: Part) -> ExactBoundary:
    (found,) = (each for each in part.boundaries if each.name == "bore")
    assert isinstance(found, ExactBoundary)
    return found


def test_clearance_of_bore_and_keyway() -> None:
    """Half of it on each side; the bottom of the keyway moves with the key's clearance alone."""
    spec = PrintSpec(bore_clearance=0.3, key_clearance=0.2).with_clearance(KEYED)
    assert spec.bore == pytest.approx(20.3)
    assert spec.keyway is not None
    assert spec.keyway.width == pytest.approx(6.2)
    vertices = _bore(made(Contact.INNER, spec)).exact.vertices * np.exp(-0.4j)
    assert (
        np.max(vertices.real),
        np.max(vertices.imag),
        np.min(np.abs(vertices)),
    ) == pytest.approx((10.0 + 2.8 + 0.1, 3.1, 10.15), abs=1e-12)
    only_bore = PrintSpec(bore_clearance=0.3).with_clearance(KEYED)
    assert only_bore.keyway is not None
    assert only_bore.keyway.width == 6.0
    assert 0.5 * 20.3 + only_bore.keyway.depth == pytest.approx(12.8, abs=1e-12)


def test_clearance_of_a_flat() -> None:
    flat = replace(DISC, d_shaft=DShaft(17.0))
    spec = PrintSpec(bore_clearance=0.4, key_clearance=0.2).with_clearance(flat)
    assert spec.d_shaft is not None
    radius = 0.5 * (spec.bore or 0.0)
    assert radius == pytest.approx(10.2)
    assert spec.d_shaft.across - radius == pytest.approx(7.0 + 0.1, abs=1e-12)


def test_no_clearance_leaves_the_part() -> None:
    assert PrintSpec(elephant_foot=Foot(0.1, 0.2)).with_clearance(KEYED) is KEYED
    assert PrintSpec(bore_clearance=0.3).with_clearance(PartSpec()) == PartSpec()
    part = made(Contact.INNER, KEYED)
    assert compensate_part(part, PrintSpec(bore_clearance=0.3)) is part


def test_the_foot_is_drawn_in_step_by_step() -> None:
    part = made(Contact.INNER, replace(KEYED, bolt_circle=Holes(3, 46.0, 5.0)))
    found = compensate_part(part, PrintSpec(elephant_foot=Foot(0.3, 0.6, 3)))
    assert [(each.name, each.z0) for each in found.layers] == [
        ("foot", -10.0),
        ("foot", pytest.approx(-9.8)),
        ("foot", pytest.approx(-9.6)),
        ("disc", pytest.approx(-9.4)),
    ]
    for number, inset in enumerate((0.3, 0.2, 0.1, 0.0)):
        outline, bore, hole, *_ = found.layers[number].boundaries
        assert (outline.farthest()[0], outline.nearest(), bore.nearest()) == pytest.approx(
            (47.0 - inset, 32.0 - inset, 10.0 + inset), abs=1e-9
        )
        assert (bore.farthest()[0], hole.farthest()[0]) == pytest.approx(
            (abs(complex(12.8 + inset, 3.0 + inset)), 23.0 + 2.5 + inset), abs=1e-9
        )
    assert found.layers[-1].boundaries == part.layers[0].boundaries
    assert [each.name for each in found.levels][1:] == [
        "floor of the foot", "floor of the foot", "lower face of the disc", "upper face",
    ]  # fmt: skip


def test_a_foot_of_a_lower_hub() -> None:
    """Only what stands on the bed is drawn in."""
    part = made(Contact.GROOVE, replace(DISC, hub=Hub(40.0, 6.0, "lower")))
    found = compensate_part(part, PrintSpec(elephant_foot=Foot(0.2, 1.0)))
    foot = found.layers[0]
    assert [each.name for each in foot.boundaries] == ["lower hub at step 1", "bore at step 1"]
    assert foot.boundaries[0].farthest()[0] == pytest.approx(19.8)
    assert found.layers[2:] == part.layers[1:]


@pytest.mark.parametrize(
    ("spec", "printed", "key", "message"),
    [
        (KEYED, PrintSpec(bore_clearance=6.0), "bore_clearance", "no room for it"),
        (replace(KEYED, hub=Hub(20.1, 5.0)), PrintSpec(bore_clearance=0.3), "bore_clearance",
         "no room for it"),
        (DISC, PrintSpec(elephant_foot=Foot(0.2, 10.0)), "elephant_foot.height", "."),
        (DISC, PrintSpec(elephant_foot=Foot(11.0, 0.2)), "elephant_foot.inset", "."),
        (DISC, PrintSpec(elephant_foot=Foot(40.0, 0.2)), "elephant_foot.inset", "."),
        (replace(DISC, chamfers=Chamfers(outline=Chamfer(1.0))),
         PrintSpec(elephant_foot=Foot(0.3, 0.2)), "elephant_foot",
         "edges of the lowest face have chamfers"),
    ],
)  # fmt: skip
def test_what_has_no_room_is_refused(
    spec: PartSpec, printed: PrintSpec, key: str, message: str
) -> None:
    """A keyway that the clearance eats, a hub; a foot, also where there are chamfers."""
    with refused(f"print.{key}", message):
        compensate_part(made(Contact.INNER, printed.with_clearance(spec)), printed)


def test_holes_that_a_foot_would_join() -> None:
    """0.5 mm lie between hole and bore."""
    part = made(Contact.INNER, replace(DISC, bolt_circle=Holes(2, 30.0, 9.0)))
    assert compensate_part(part, PrintSpec(elephant_foot=Foot(0.2, 0.2))).layers[0].name == "foot"
    with pytest.raises(GeometryError, match="bore and bolt hole 1 would touch"):
        compensate_part(part, PrintSpec(elephant_foot=Foot(0.26, 0.2)))


@given(st.sampled_from(list(FLANKS)), specs(), st.floats(-9.0, 19.0), st.floats(-9.0, 19.0))
@attack
def test_scaling_multiplies_volume_and_moments(
    contact: Contact, spec: PartSpec, xy: float, z: float
) -> None:
    part = made_or_refused(contact, spec)
    assume(part is not None and part.thickness)
    assert part is not None
    shrinkage = Shrinkage(xy, z)
    found = compensate_part(part, PrintSpec(shrinkage=shrinkage))
    a, b = shrinkage.scale_xy, shrinkage.scale_z
    before, after = Solid.from_part(part), Solid.from_part(found)
    assert (after.volume, after.axial) == pytest.approx(
        (before.volume * a**2 * b, before.axial * a**4 * b), rel=1e-9
    )
    # Shrunk again by what was stated, it is the part.
    assert found.thickness * (1.0 - 0.01 * z) == pytest.approx(part.thickness, rel=1e-12)
    reach = found.outermost.farthest()[0] * (1.0 - 0.01 * xy)
    assert reach == pytest.approx(part.outermost.farthest()[0], rel=1e-12)


def test_all_at_once() -> None:
    """The foot is counted in millimetres of the file, whatever the scale."""
    spec = PrintSpec(0.3, 0.2, Foot(0.25, 0.4), Shrinkage(1.0, 2.0))
    found = compensate_part(made(Contact.INNER, spec.with_clearance(KEYED)), spec)
    foot, disc = found.layers
    assert (
        foot.z1 - foot.z0,
        disc.z1 - foot.z0,
        disc.boundaries[0].farthest()[0],
    ) == pytest.approx((0.4, 10.0 / 0.98, 47.0 / 0.99))
    assert (foot.boundaries[0].farthest()[0], disc.boundaries[1].nearest()) == pytest.approx(
        (47.0 / 0.99 - 0.25, 10.15 / 0.99)
    )
    assert foot.boundaries[1].nearest() == pytest.approx(10.15 / 0.99 + 0.25)
    assert math.isclose(disc.z1, 0.0)


def test_chamfers_are_scaled_with_the_part() -> None:
    """Also where they are no longer of 45 degrees; upper ones stay above a foot."""
    edges = Chamfers(outline=Chamfer(1.0, "upper"), bore=Chamfer(0.5, "upper"))
    part = made(Contact.INNER, replace(DISC, chamfers=edges))
    spec = PrintSpec(shrinkage=Shrinkage(xy=2.0, z=1.0))
    stretched, xy, z = compensate_part(part, spec), spec.scale_xy, spec.scale_z
    assert stretched.thickness == pytest.approx(10.0 * z)
    assert Solid.from_part(stretched).volume == pytest.approx(
        xy**2 * z * Solid.from_part(part).volume, rel=1e-12
    )
    footed = compensate_part(part, PrintSpec(elephant_foot=Foot(0.3, 0.2)))
    assert footed.bevels == part.bevels


FACTOR = 1.02

CENTRE = 3.0 - 4.0j

CIRCLE = ScaledBoundary(CircleBoundary("bore", True, 10.0, CENTRE), FACTOR)

EXACT = CircleBoundary("bore", True, 10.0 * FACTOR, CENTRE * FACTOR)

FLANK = CurveBoundary("outline", False, INNER)

TOLERANCE = 0.01


def test_lines_and_arcs_stay_exact() -> None:
    bore = ExactBoundary("bore", True, bore_outline(20.0, Keyway(6.0, 2.8)), Contour.circle(10.0))
    found = scaled(bore, FACTOR)
    assert isinstance(found, ExactBoundary)
    larger = bore_outline(20.0 * FACTOR, Keyway(6.0 * FACTOR, 2.8 * FACTOR))
    assert found.exact.vertices == pytest.approx(larger.vertices, abs=1e-14)
    assert found.round_radius == pytest.approx(10.0 * FACTOR, rel=1e-15)
    assert scaled(bore, 1.0) is bore


@pytest.mark.parametrize("form", ["arcs", "polyline", "distance_fit", "spline"])
@pytest.mark.parametrize("boundary", [CIRCLE, scaled(FLANK, FACTOR)], ids=["circle", "flank"])
def test_a_fit_keeps_its_tolerance_at_the_larger_scale(form: str, boundary: Boundary) -> None:
    found = getattr(boundary, form)(TOLERANCE)
    assert 0.0 <= found.deviation <= TOLERANCE == found.tolerance
    assert boundary.hole is (boundary is CIRCLE)
    if boundary is not CIRCLE:
        assert boundary.deviation(found.contour) <= TOLERANCE * (1.0 + 1e-9)
    elif form in ("arcs", "polyline"):
        off = EXACT.deviation(found.contour)
        assert 0.9 * TOLERANCE <= off <= found.deviation + 1e-13  # the stub spends what it gets


def test_a_contour_that_is_off_is_found_to_be() -> None:
    boundary = scaled(FLANK, FACTOR)
    unscaled = FLANK.polyline(1e-3).contour
    nearest, (farthest, _) = FLANK.nearest(), FLANK.farthest()
    assert boundary.deviation(unscaled) >= (FACTOR - 1.0) * nearest - 1e-3
    assert boundary.deviation(scaled_contour(unscaled, FACTOR)) <= 1.1 * FACTOR * 1e-3
    splines = FLANK.spline(1e-2).contour
    assert boundary.deviation(scaled_splines(splines, FACTOR)) <= 1.1 * FACTOR * 1e-2
    assert boundary.deviation(splines) >= (FACTOR - 1.0) * nearest - 1e-2
    assert (boundary.nearest(), boundary.farthest()[0]) == (FACTOR * nearest, FACTOR * farthest)


def test_moments_and_parallels() -> None:
    moments, exact = CIRCLE.moments(1e-10), EXACT.moments(1e-10)
    assert moments.area == pytest.approx(exact.area, rel=1e-14)
    assert moments.first == pytest.approx(exact.first, rel=1e-13)
    second, whole = CIRCLE.second_moments(1e-10), EXACT.second_moments(1e-10)
    assert (second.polar, second.square) == pytest.approx((whole.polar, whole.square), rel=1e-13)
    cutter = CIRCLE.offset(2.0)
    points = cutter.arcs(1e-6).contour.vertices
    assert np.abs(points - CENTRE * FACTOR) == pytest.approx(10.0 * FACTOR - 2.0, abs=1e-12)


def test_pickles_and_doors() -> None:
    found = pickle.loads(pickle.dumps(CIRCLE))
    assert (found.name, found.factor, found.unscaled) == ("bore", FACTOR, CIRCLE.unscaled)
    with pytest.raises(GeometryError, match="must be a boundary"):
        ScaledBoundary("bore", 1.1)  # type: ignore[arg-type]  # wrong on purpose
    with pytest.raises(GeometryError):
        ScaledBoundary(CIRCLE, -1.0)


CLOSE = 1e-3
"""Of the contours that are compared [mm]."""

OUTLINES = ("plate_translating", "tappet", "flat_rocker", "knife_edge", "trimmed_ring", "cut_lobe")
"""Rollers, faces and edges, a hole, outlines with corners, and one that a lobe was cut off."""


@cache
def _flank(scene: str) -> Boundary:
    """The outline of a fixture scene."""
    part = camgeo.load(SCENES / f"{scene}.toml").disc.drawn.part
    return next(each for each in part.boundaries if isinstance(each, CurveBoundary))


def _polygon(boundary: Boundary, tolerance: float = CLOSE) -> shapely.Polygon:
    points = boundary.polyline(tolerance, "fast").contour.vertices
    return shapely.Polygon(np.column_stack((points.real, points.imag)))


@pytest.mark.parametrize("scene", OUTLINES)
@pytest.mark.parametrize("distance", [0.2, 1.5])
def test_a_flank_drawn_in_lies_that_far_in_the_material(scene: str, distance: float) -> None:
    """Each point of it is at that distance from the flank, and nothing is missing: it encloses the
    area that shapely finds.
    """
    flank = _flank(scene)
    found = inset_boundary(flank, distance, "moved")
    assert (found.name, found.hole) == ("moved", flank.hole)
    before, after = _polygon(flank), _polygon(found)
    away = shapely.distance(before.exterior, shapely.points(after.exterior.coords))
    assert away == pytest.approx(distance, abs=2.0 * CLOSE)
    wanted = before.buffer(distance if flank.hole else -distance, quad_segs=1000)
    slack = 2.0 * CLOSE * before.exterior.length
    assert after.area == pytest.approx(wanted.area, abs=slack)


@pytest.mark.parametrize("scene", ["plate_translating", "tappet"])
def test_a_flank_of_which_nothing_is_left(scene: str) -> None:
    with pytest.raises(GeometryError, match="leaves nothing of the outline"):
        inset_boundary(_flank(scene), 200.0, "moved")


def test_only_outlines_and_lines_and_arcs_are_drawn_in() -> None:
    corners = np.array([0.0, 8.0, 8.0j])
    middles = 0.5 * (corners + np.roll(corners, -1))
    pieces = np.column_stack((corners, middles, np.roll(corners, -1)))
    letter = LetterBoundary("letter", True, pieces, 0.01)
    with pytest.raises(GeometryError, match="the letter cannot be inset"):
        inset_boundary(letter, 0.1, "moved")


def test_what_is_scaled_is_drawn_in_by_as_much() -> None:
    found = inset_boundary(ScaledBoundary(_flank("tappet"), 2.0), 0.3, "moved")
    assert isinstance(found, ScaledBoundary)
    assert (found.name, found.factor) == ("moved", 2.0)
    own = inset_boundary(_flank("tappet"), 0.15, "own")
    assert (found.farthest()[0], found.nearest()) == (2.0 * own.farthest()[0], 2.0 * own.nearest())


HOLES = {
    "circle": Contour.circle(10.0, 3.0 + 4.0j),
    "keyway": bore_outline(20.0, Keyway(6.0, 2.8, 0.7)),
    "d": flattened(20.0, DShaft(16.0, -1.0)),
    "slot": mark_outline(Mark(25.0, 2.0, 0.5, 6.0, 1.1)),
    "polygon": Contour.polygon(np.array([0.0, 8.0, 6.0 + 3.0j, 7.0 + 9.0j, 2.0j])),
    "clockwise": bore_outline(20.0, Keyway(6.0, 2.8)).reversed(),
}


@pytest.mark.parametrize("name", HOLES)
@given(st.floats(-0.9, 2.0).filter(lambda by: abs(by) > 1e-3))
@settings(attack, max_examples=examples(4, long=60))
def test_parallels_of_lines_and_arcs(name: str, by: float) -> None:
    """As of shapely, with corners that stay corners."""
    fine = 1e-2 * CLOSE
    hole = ExactBoundary(name, True, HOLES[name])
    moved = inset_boundary(ExactBoundary(name, by > 0.0, HOLES[name]), abs(by), name)
    wanted = _polygon(hole, fine).buffer(by, join_style="mitre", mitre_limit=20.0)
    found = _polygon(moved, fine)
    # At a corner, the direction of a chord of an arc, of 1 mm at least, is off by this angle; and
    # the sharpest corner magnifies what that moves less than 5 times.
    off = fine + abs(by) * math.sqrt(8.0 * fine)
    assert shapely.hausdorff_distance(found.exterior, wanted.exterior) <= 5.0 * off
    slack = fine * wanted.exterior.length + len(moved.distance_fit(fine).contour) * abs(by) * off
    assert found.area == pytest.approx(wanted.area, abs=2.0 * slack)


def test_circles_and_squares_exactly() -> None:
    circle = parallel(Contour.circle(5.0, 2.0j), -1.25)
    assert np.abs(circle.vertices - 2.0j) == pytest.approx(3.75, rel=1e-15)
    assert circle.area == pytest.approx(math.pi * 3.75**2, rel=1e-15)
    square = parallel(Contour.polygon(np.array([0.0, 4.0, 4.0 + 4.0j, 4.0j])), 0.5)
    assert square.vertices.tolist() == [-0.5 - 0.5j, 4.5 - 0.5j, 4.5 + 4.5j, -0.5 + 4.5j]


@pytest.mark.parametrize(
    ("name", "by"),
    [("circle", -10.0), ("keyway", -3.0), ("d", -9.5), ("slot", -1.0), ("polygon", -4.0)],
)
def test_what_vanishes_is_refused(name: str, by: float) -> None:
    with pytest.raises(GeometryError, match=f"leaves nothing of the {name}"):
        inset_boundary(ExactBoundary(name, False, HOLES[name]), -by, name)


# The table, rollers and rings ---------------------------------------------------------------------


TABLE = {
    "bore_clearance": 0.2,
    "key_clearance": 0.1,
    "elephant_foot": {"inset": 0.3, "height": 0.6, "steps": 3},
    "shrinkage": {"xy": 0.5, "z": -1.0},
}


def test_a_whole_table() -> None:
    spec = instance_from_table(PrintSpec, TABLE)
    assert spec.elephant_foot == Foot(0.3, 0.6, 3)
    assert spec.elephant_foot.insets == pytest.approx((0.3, 0.2, 0.1))
    assert (spec.scale_xy, spec.scale_z) == pytest.approx((100.0 / 99.5, 100.0 / 101.0), rel=1e-15)
    assert spec.compensates
    assert spec.facts == {
        "bore_clearance_mm": 0.2,
        "key_clearance_mm": 0.1,
        "foot_inset_mm": 0.3,
        "foot_height_mm": 0.6,
        "foot_steps": 3,
        "scale_xy": spec.scale_xy,
        "scale_z": spec.scale_z,
    }
    assert spec.text == (
        "bore 0.2 mm larger in diameter, 0.1 mm per side; keyway or flat with 0.1 mm clearance,"
        " 0.05 mm per side; lowest 0.6 mm drawn in by 0.3 mm per side in 3 steps; scaled by 1.00503"
        " in X and Y, 0.990099 in Z"
    )


@pytest.mark.parametrize("table", [{}, {"shrinkage": {}}, {"shrinkage": {"xy": 0, "z": 0.0}}])
def test_what_compensates_nothing(table: dict[str, Any]) -> None:
    spec = instance_from_table(PrintSpec, table)
    assert not spec.compensates
    assert (spec.facts, spec.text) == ({}, "")


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"bore_clearance": 0.0}, "bore_clearance"),
        ({"key_clearance": -0.1}, "key_clearance"),
        ({"elephant_foot": {"inset": 0.1, "height": 0.0}}, "elephant_foot.height"),
        ({"elephant_foot": {"inset": "x", "height": 0.1}}, "elephant_foot.inset"),
        ({"elephant_foot": {"inset": 1, "height": 1, "steps": 21}}, "elephant_foot.steps"),
        ({"shrinkage": {"xy": 20.5}}, "shrinkage.xy"),
        ({"shrinkage": {"z": float("nan")}}, "shrinkage.z"),
    ],
)
def test_refusals(table: dict[str, Any], key: str) -> None:
    with refused(f"print.{key}"):
        instance_from_table(PrintSpec, table)


def test_types() -> None:
    with pytest.raises(GeometryError):
        PrintSpec(elephant_foot=Shrinkage())  # type: ignore[arg-type]  # wrong on purpose


KEYED_DISC = PartSpec(thickness=10.0, bore=20.0, rim=140.0, keyway=Keyway(6.0, 2.8, 0.4))


@pytest.mark.parametrize("bore", [None, 6.0])
@pytest.mark.parametrize("clearance", [0.0, 0.2])
def test_a_roller(bore: float | None, clearance: float) -> None:
    part = roller_part(8.0, 5.0, bore, PrintSpec(bore_clearance=clearance) if clearance else None)
    hole = 0.0 if bore is None else 0.5 * (bore + clearance)
    assert Solid.from_part(part).volume == pytest.approx(
        math.pi * (64.0 - hole**2) * 5.0, rel=1e-12
    )
    assert part.outermost.farthest()[0] == 8.0


def test_a_roller_with_too_large_a_bore() -> None:
    with refused("output.3mf.roller_bore", r"less than 15\.8 mm"):
        roller_part(8.0, 5.0, 15.9, PrintSpec(bore_clearance=0.2))


def test_a_ring_has_the_bore_of_the_part() -> None:
    spec = PrintSpec(bore_clearance=0.2, key_clearance=0.1).with_clearance(KEYED_DISC)
    fitted = made(Contact.INNER, spec)
    ring = ring_part(fitted)
    outer, bore = ring.layers[0].boundaries
    assert bore in fitted.boundaries
    assert outer.nearest() == pytest.approx(abs(complex(12.85, 3.05)) + 3.0, abs=1e-9)
    assert ring.thickness == 6.0
    thin = ring_part(made(Contact.INNER, replace(KEYED_DISC, thickness=4.0)))
    assert thin.thickness == 4.0
    large = ring_part(made(Contact.INNER, replace(KEYED_DISC, bore=40.0, keyway=None)))
    assert large.layers[0].boundaries[0].nearest() == pytest.approx(24.0)


def test_a_ring_needs_a_bore() -> None:
    with refused("output.3mf.plate", "needs the bore"):
        ring_part(made(Contact.INNER, replace(KEYED_DISC, bore=None, keyway=None)))


# What a nozzle cannot make ------------------------------------------------------------------------


def _found(part: Part, nozzle: float) -> dict[str, Finding]:
    return {each.name: each for each in nozzle_findings(part, nozzle)}


@pytest.mark.parametrize(
    ("nozzle", "severity", "limit"),
    [(0.24, "ok", 0.48), (0.26, "warning", 0.52), (0.51, "broken", 0.51)],
)
def test_walls(nozzle: float, severity: str, limit: float) -> None:
    """0.5 mm between bore and hole, on the x axis."""
    part = made(Contact.INNER, replace(DISC, bolt_circle=Holes(1, 30.0, 9.0)))
    wall = _found(part, nozzle)[WALL]
    assert (wall.severity, wall.limit) == (severity, limit)
    assert wall.value == pytest.approx(0.5, abs=1e-9)
    assert "between bore and bolt hole 1, at (10.5, " in wall.sentence


@cache
def _scene(name: str) -> Part:
    return camgeo.load(SCENES / f"{name}.toml").disc.drawn.part


@pytest.mark.parametrize("scene", ["plate_translating", "tappet", "ring", "groove", "setzhub"])
def test_the_smallest_radius_of_flanks(scene: str) -> None:
    """As of circles through three neighbouring points of the flanks."""
    part = _scene(scene)
    radii = []
    for boundary in part.boundaries:
        if isinstance(boundary, CurveBoundary):
            (stretch,) = boundary.path.stretches
            for low, high in zip(stretch.marks[:-1], stretch.marks[1:], strict=True):
                phi = np.linspace(low, high, 2001)[1:-1]
                a, b, c = (stretch.curve.point(phi + k * 1e-4 * (high - low)) for k in (-1, 0, 1))
                turned = (np.conj(b - a) * (c - b)).imag
                sides = np.abs(b - a) * np.abs(c - b) * np.abs(c - a)
                with np.errstate(divide="ignore"):
                    radii.append(np.min(sides / (2.0 * np.abs(turned))))
    found = _found(part, 0.4)[RADIUS]
    assert found.severity == "ok"
    assert found.value == pytest.approx(min(radii), rel=1e-3)


def test_radii_below_half_the_nozzle() -> None:
    radius = _found(_scene("plate_translating"), 0.4)[RADIUS].value
    assert radius is not None
    assert _found(_scene("plate_translating"), 1.99 * radius)[RADIUS].severity == "ok"
    poor = _found(_scene("plate_translating"), 2.01 * radius)[RADIUS]
    assert poor.severity == "warning"
    assert "rounded off" in poor.sentence or "filled in" in poor.sentence


def test_corners_have_no_radius() -> None:
    corner = _found(_scene("trimmed_ring"), 0.4)[RADIUS]
    assert (corner.severity, corner.value, corner.limit) == ("warning", 0.0, 0.2)
    assert "the outline has a corner at cam angle" in corner.sentence
    assert corner.cam_angle is not None


@pytest.mark.parametrize("length", [None, 4.0])
@pytest.mark.parametrize("width", [0.3, 0.397, 0.4, 0.6])
def test_marks(length: float | None, width: float) -> None:
    part = made(Contact.INNER, replace(DISC, mark=Mark(25.0, width, 0.5, length)))
    found = _found(part, 0.4)
    assert (STROKE in found) == (width < 0.399)
    if STROKE in found:
        stroke = found[STROKE]
        assert stroke.severity == "warning"
        assert stroke.value == pytest.approx(width, abs=2e-3)
        assert "a stroke of the mark" in stroke.sentence


def _engraved(*boundaries: ExactBoundary) -> Part:
    plate = ExactBoundary("outline", False, Contour.circle(50.0))
    low, high = Layer(-10.0, -0.5, (plate,)), Layer(-0.5, 0.0, (plate, *boundaries), "text")
    return Part((low, high))


def _outline(*points: complex, name: str = "text", hole: bool = True) -> ExactBoundary:
    return ExactBoundary(name, hole, Contour.polygon(np.array(points)))


T = _outline(1.85, 2.15, 2.15 + 4j, 4 + 4j, 4 + 5j, 0 + 5j, 0 + 4j, 1.85 + 4j)
"""The bar 1 mm wide, the stem 0.3 mm."""

H = _outline(0, 1, 1 + 2.3j, 3 + 2.3j, 3, 4, 4 + 5j, 3 + 5j, 3 + 2.7j, 1 + 2.7j, 1 + 5j, 5j)
"""The stems 1 mm wide, the bar between them 0.4 mm."""

A = _outline(0, 1, 3 + 6j, 5, 6, 3.6 + 7j, 2.4 + 7j)
"""Strokes above 0.8 mm, with sharp corners."""

RING = (
    ExactBoundary("ring", True, Contour.circle(4.0)),
    ExactBoundary("island", False, Contour.circle(3.0, 0.75)),
)
"""0.25 mm wide at its narrowest."""


@pytest.mark.parametrize(
    ("boundaries", "width"),
    [((T,), 0.3), ((H,), 0.4), (RING, 0.25), ((A,), None), ((A, *(
        ExactBoundary(each.name + "s", each.hole, each.exact) for each in (
            _outline(20, 20.2, 20.2 + 5j, 20 + 5j),)),), 0.2)],
    ids=["stem", "bar", "ring", "corners", "the narrowest"],
)  # fmt: skip
def test_strokes(boundaries: tuple[ExactBoundary, ...], width: float | None) -> None:
    found = _found(_engraved(*boundaries), 0.5)
    assert (found[STROKE].value if STROKE in found else None) == (
        width if width is None else pytest.approx(width, abs=3e-3)
    )
    if width is not None:
        assert STROKE not in _found(_engraved(*boundaries), 0.9 * width)


@pytest.mark.parametrize(("height", "narrow"), [(2.9, True), (3.0, False)])
def test_strokes_of_a_text(height: float, narrow: bool) -> None:
    """A stem of the font is 202 of its units wide, where a capital letter is 1493 high."""
    text = Engraving("I", height, 0.5, 20.0)
    found = _found(made(Contact.INNER, replace(DISC, engraving=(text,))), 0.4)
    assert (STROKE in found) == narrow
    if narrow:
        assert found[STROKE].value == pytest.approx(202.0 / 1493.0 * height, abs=2e-3)
        assert "a stroke of the engraving 1 letter" in found[STROKE].sentence


def test_the_place_of_a_stroke_lies_in_it() -> None:
    place = _found(_engraved(T), 0.5)[STROKE].sentence.split("(")[1].split(")")[0]
    x, y = map(float, place.split(","))
    assert 1.85 <= x <= 2.15
    assert 0.0 <= y <= 4.0


def test_what_is_sunk() -> None:
    """Holes that go through, hubs and flanks are no strokes; islands belong to what is around."""
    part = made(Contact.GROOVE, replace(DISC, mark=Mark(68.0, 1.0, 0.5)))
    assert [name for name, _ in sunk(part)] == ["mark"]
    ((name, region),) = sunk(_engraved(*RING))
    assert name == "ring"
    assert len(region.interiors) == 1
    assert region.area == pytest.approx(math.pi * 7.0, rel=1e-3)
    assert isinstance(region, shapely.Polygon)
