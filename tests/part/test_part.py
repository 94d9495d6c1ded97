"""Parts: layers of boundaries, their mass and walls."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour, Fit, winding_number
from camgeo.geometry.outline.path import Path, Pivot, SecondMoments, area, radii, whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.part import boundaries
from camgeo.part.assembly import bore_boundary, bore_outline, build_part
from camgeo.part.boundaries import CurveBoundary, ExactBoundary, largest_radius, smallest_radius
from camgeo.part.mass import (
    SHARE,
    TOLERANCES,
    Solid,
    Web,
    disc_moments,
    largest_diameter,
    section_area,
)
from camgeo.part.materials import MATERIALS, find_material
from camgeo.part.part import Layer, Part, PartEdge, Wall, part_edges
from camgeo.part.spec import (
    ROWS,
    SMALLEST,
    Chamfer,
    Counterbore,
    DShaft,
    Engraving,
    Holes,
    Hub,
    Keyway,
    KeywayRow,
    Mark,
    Pair,
    PartSpec,
    SetScrew,
    din_6885_1,
)
from camgeo.scene.schema import schema
from camgeo_export.reading import layer_name, part_layers
from tests.contour.cams import flank, outline, polyline
from tests.contour.paths import cut_off_lobe, swallow_tail
from tests.draws.walls import misses
from tests.effects.scenes import design
from tests.end_to_end.features import bore
from tests.outline.test_path import eccentric
from tests.part.parts import (
    FLANKS,
    INNER,
    OUTER,
    PITCH,
    ROLLER,
    circle,
    made,
    made_or_refused,
    polygon_of,
    refused,
    specs,
)
from tests.strategies import attack

some = settings(max_examples=50, deadline=None)


@some
@given(st.floats(5.0, 60.0), st.floats(0.05, 0.95), st.floats(0.1, 10.0), st.floats(-6.2, 6.2))
def test_bore_with_keyway(diameter: float, share: float, depth: float, angle: float) -> None:
    keyway = Keyway(share * diameter, depth, angle)
    contour = bore_outline(diameter, keyway)
    exact = bore(PartSpec(bore=diameter, keyway=keyway))
    assert (contour.area, contour.length) == pytest.approx((exact.area, exact.length), rel=1e-12)
    assert winding_number(contour, 0j) == 1
    along = contour.vertices * np.exp(-1j * angle)
    radius, half = diameter / 2.0, keyway.width / 2.0
    # The slot's sides at half its width off the middle line, its bottom `depth` beyond the bore.
    assert np.abs(along.imag) == pytest.approx(np.full(4, half), rel=1e-12)
    assert sorted(along.real)[2:] == pytest.approx([radius + depth] * 2, rel=1e-12)
    assert np.sum(np.isclose(np.abs(along), radius, rtol=1e-12)) == 2
    far = np.max(np.abs(outline(contour).dense(4_000)))
    assert largest_radius(bore_outline(diameter, keyway)) == pytest.approx(far, rel=1e-12)


def test_groove() -> None:
    spec = PartSpec(thickness=10.0, rim=140.0, bore=20.0, groove_depth=4.0)
    part = made(Contact.GROOVE, spec)
    walls = [(wall.boundary.name, wall.boundary.hole, wall.z0, wall.z1) for wall in part.walls]
    assert walls == [
        ("rim", False, -10.0, 0.0),
        ("bore", True, -10.0, 0.0),
        ("inner flank", False, -4.0, 0.0),
        ("outer flank", True, -4.0, 0.0),
    ]
    assert [wall[0] for wall in walls] == [each.name for each in part.boundaries]
    below, floor, above = part.levels
    assert (below.z, floor.z, above.z) == (-10.0, -4.0, 0.0)
    assert [each.name for each in floor.above] == ["inner flank", "outer flank"]
    assert (floor.name, floor.below) == ("floor of the groove", ())
    assert above.below == part.boundaries
    # The groove is as wide as the roller, everywhere.
    inner, outer = (boundary.arcs(0.001).contour for boundary in part.boundaries[2:])
    distances = outline(outer).distances(outline(inner).dense(2_000))
    assert distances == pytest.approx(np.full(len(distances), 2.0 * ROLLER), abs=0.002)


RIM, HUB, BORE = circle("rim", 40.0), circle("hub", 15.0), circle("bore", 8.0, hole=True)


def test_a_boundary_goes_on_through_layers() -> None:
    part = Part((Layer(-10.0, 0.0, (RIM, BORE)), Layer(0.0, 5.0, (HUB, BORE), "hub")))
    assert [(wall.boundary, wall.z0, wall.z1) for wall in part.walls] == [
        (RIM, -10.0, 0.0),
        (BORE, -10.0, 5.0),
        (HUB, 0.0, 5.0),
    ]
    _, shoulder, _ = part.levels
    assert (shoulder.below, shoulder.above) == ((RIM,), (HUB,))
    assert (part.boundaries, part.thickness) == ((RIM, BORE, HUB), 15.0)


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        (lambda: (), "needs layers"),
        (lambda: (Layer(0.0, 1.0, ()),), "needs boundaries"),
        (lambda: (Layer(0.0, 1.0, (BORE, BORE)),), "each with its own name"),
        (lambda: (Layer(1.0, 0.0, (RIM,)),), "must reach upwards"),
        (lambda: (Layer(math.nan, 0.0, (RIM,)),), "must be a finite number"),
        (lambda: (Layer(0.0, math.inf, (RIM,)),), "must be a finite number"),
        (lambda: (Layer("0", 1.0, (RIM,)),), "must be a finite number"),  # type: ignore[arg-type]  # wrong on purpose
        (lambda: (Layer(0.0, 1.0, RIM),), "must be a tuple of boundaries"),  # type: ignore[arg-type]  # wrong on purpose
        (lambda: (Layer(0.0, 1.0, (3,)),), "must be a boundary of a part"),  # type: ignore[arg-type]  # wrong on purpose
        (lambda: (RIM,), "needs layers"),
        (lambda: (Layer(0.0, 1.0, (RIM,)), Layer(2.0, 3.0, (RIM,), "hub")), "must begin where"),
        (
            lambda: (Layer(0.0, 1.0, (RIM,)), Layer(1.0, 2.0, (circle("rim", 9.0),))),
            "its own name",
        ),
    ],
)
def test_layers_that_are_no_part(layers: Callable[[], tuple[Layer, ...]], message: str) -> None:
    with refused("part", message):
        Part(layers())


@pytest.mark.parametrize(
    ("bore", "keyway", "fits"),
    [
        # The flank comes as near to the axis as 32 mm; the tolerance is 0.01 mm.
        (2.0 * (32.0 - 0.0101), None, True),
        (2.0 * (32.0 - 0.0099), None, False),
        # Towards the dwell at its smallest radius, 32 mm: 30 + 1.5 fits, 30 + 2.5 does not;
        # corners of a slot of 8 mm reach hypot(31.5, 4) = 31.75 and hypot(32.5, 4).
        (60.0, Keyway(8.0, 1.5, math.pi / 2.0), True),
        (60.0, Keyway(8.0, 2.5, math.pi / 2.0), False),
        # On the other side the flank is 47 mm away.
        (60.0, Keyway(8.0, 2.5, -math.pi / 2.0), True),
        (60.0, Keyway(8.0, 16.5, -math.pi / 2.0), True),
        (60.0, Keyway(8.0, 17.5, -math.pi / 2.0), False),
        (90.0, None, False),
        (1e3, None, False),
    ],
)
def test_bore_must_fit(bore: float, keyway: Keyway | None, fits: bool) -> None:
    spec = PartSpec(thickness=10.0, bore=bore, keyway=keyway)
    if fits:
        made(Contact.INNER, spec)
        return
    with refused("part.bore", r"the outline comes as near as 3(1\.9|2)"):
        made(Contact.INNER, spec)


@pytest.mark.parametrize("contact", ["outer", "groove"])
@pytest.mark.parametrize(
    ("rim", "message"),
    [
        (125.9, "more than 126"),
        (100.0, "more than 126"),
        (None, "needs the diameter of its rim"),
    ],
)
def test_rim_must_be_outside(contact: Contact, rim: float | None, message: str) -> None:
    spec = PartSpec(thickness=10.0, rim=126.5, groove_depth=4.0)
    made(contact, spec)
    with pytest.raises(GeometryError, match=message):
        made(contact, replace(spec, rim=rim))


def test_undercut_is_no_part() -> None:
    """It is found when its outline is asked for; a design refuses such a disc before."""
    undercut = whole(WorkingCurve(PITCH, -60.0))
    part = build_part(Contact.INNER, undercut, OUTER, PartSpec(), 0.01)
    for ask in (part.boundaries[0].arcs, part.boundaries[0].polyline):
        with pytest.raises(UndercutError):
            ask(0.01)


@pytest.mark.parametrize("name", [("setzhub", -1), ("schnitt", -1), ("groove", 1)], ids=str)
def test_extreme_radii(name: tuple[str, int]) -> None:
    from camgeo.geometry.contour.arcs import fit_arcs

    contour = fit_arcs(whole(flank(*name)), 0.01).contour
    radii = np.abs(outline(contour).dense(50_000))
    # Samples 0.01 mm apart miss an extreme by 0.01^2/8 over the radius there, 1 mm at least.
    assert (smallest_radius(contour), largest_radius(contour)) == pytest.approx(
        (float(np.min(radii)), float(np.max(radii))), abs=2e-5
    )
    assert smallest_radius(contour) <= np.min(radii) + 1e-12
    assert largest_radius(contour) >= np.max(radii) - 1e-12


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(("distance", "nearest", "farthest"), [(-8, 32, 47), (8, 48, 63)])
def test_extreme_radii_of_a_flank_are_exact(
    distance: float, nearest: float, farthest: float, rotation: int
) -> None:
    pitch = PitchCurve(PITCH.motion, PITCH.follower, rotation)
    flank = CurveBoundary("outline", hole=False, path=whole(WorkingCurve(pitch, distance)))
    assert flank.nearest() == pytest.approx(nearest, rel=1e-15)
    radius, angle = flank.farthest()
    assert radius == pytest.approx(farthest, rel=1e-15)
    assert angle == pytest.approx(math.pi, rel=1e-15)  # where the upper dwell begins


@pytest.mark.parametrize("distance", [-8.0, -3.0, 0.0, 8.0])
@pytest.mark.parametrize("rotation", [1, -1])
def test_what_surely_goes_round_a_radius_does(distance: float, rotation: int) -> None:
    pitch = PitchCurve(PITCH.motion, PITCH.follower, rotation)
    flank = CurveBoundary("outline", hole=False, path=whole(WorkingCurve(pitch, distance)))
    nearest = 40.0 + distance
    assert flank.nearest() == pytest.approx(nearest)
    assert flank.surely_around(0.9 * (40.0 - abs(distance)))
    assert not flank.surely_around(nearest)


def test_what_is_trimmed_is_not_surely_round_anything() -> None:
    flank = CurveBoundary("outline", hole=False, path=swallow_tail())
    assert flank.nearest() > 0.0
    assert not flank.surely_around(0.1 * flank.nearest())


@pytest.mark.parametrize(("radius", "nearest"), [(1.0, 0.0), (2.99, 0.0), (3.01, 0.01), (8, 5)])
def test_a_disc_beside_the_axis_has_no_room_for_a_bore(radius: float, nearest: float) -> None:
    """A circle about a point 3 mm away, in three arcs."""
    third = 2.0 * math.pi / 3.0
    pivots = tuple(Pivot(3.0 + 0j, radius, cmath.rect(1.0, 0.4 + k * third), third, 0.0, 0.0)
                   for k in range(3))  # fmt: skip
    disc = CurveBoundary("outline", hole=False, path=Path(pivots))
    assert disc.nearest() == pytest.approx(nearest, rel=1e-12)


@pytest.mark.parametrize("tolerance", [0.1, 0.001])
def test_exact_boundary(tolerance: float) -> None:
    exact = bore_outline(20.0, Keyway(6.0, 2.8))
    boundary = ExactBoundary("bore", hole=True, exact=exact)
    assert boundary.arcs(tolerance).deviation == 0.0
    fit = boundary.polyline(tolerance)
    assert fit.deviation <= tolerance * (1.0 + 1e-9)
    assert fit.contour.arc_count == 0
    assert boundary.deviation(fit.contour) == pytest.approx(fit.deviation, rel=1e-6)


# Trimmed outlines -----------------------------------------------------------------------------


@pytest.mark.parametrize("trimmed", [swallow_tail, cut_off_lobe])
def test_trimmed_disc(trimmed: Callable[[], Path]) -> None:
    path = trimmed()
    part = build_part(Contact.INNER, path, path, PartSpec(thickness=10.0, bore=4.0), 0.01)
    flank = part.boundaries[0]
    tolerance = 0.001
    fit, straight = flank.arcs(tolerance), flank.polyline(tolerance)
    for found in (fit, straight):
        assert found.deviation <= tolerance
        strip = tolerance * found.contour.length
        assert found.contour.area == pytest.approx(abs(area(path)), abs=strip)
        assert flank.deviation(found.contour.reversed()) == pytest.approx(
            found.deviation, rel=0.011
        )


def test_bore_near_a_corner() -> None:
    """HC22: without the lobe the disc is the base circle of 6 mm with a corner at 9.06 mm."""
    path = cut_off_lobe()
    part = build_part(Contact.INNER, path, path, PartSpec(bore=11.9), 0.01)
    contour = part.boundaries[0].arcs(0.001).contour
    assert largest_radius(contour) == pytest.approx(9.06066828504406653, rel=1e-12)
    with pytest.raises(GeometryError, match=r"the outline comes as near as (5\.99|6)"):
        build_part(Contact.INNER, path, path, PartSpec(bore=12.1), 0.01)


@pytest.mark.parametrize("kind", [CurveBoundary, ExactBoundary])
def test_a_deviation_is_computed_once_for_the_same_contour(
    kind: type[CurveBoundary | ExactBoundary], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever vertex it begins from: a solid has each outline at two heights."""
    boundary: CurveBoundary | ExactBoundary = CurveBoundary("outline", False, INNER)
    name = "deviation"
    if kind is ExactBoundary:
        boundary = ExactBoundary("bore", True, bore_outline(20.0, Keyway(6.0, 2.0)))
        name = "deviation_bound"
    counted = Mock(wraps=getattr(boundaries, name))
    monkeypatch.setattr(boundaries, name, counted)
    contour = boundary.polyline(0.01).contour
    known = counted.call_count
    found = boundary.deviation(contour)
    turned = Contour.polygon(np.roll(contour.vertices, 5))
    assert boundary.deviation(turned) == found
    assert counted.call_count <= known + 1
    assert boundary.deviation(Contour.polygon(1.001 * contour.vertices)) > found
    assert counted.call_count <= known + 2


def test_layers_of_the_same_boundaries_have_no_face_between() -> None:
    part = Part((Layer(-6.0, -2.0, (RIM, BORE)), Layer(-2.0, 0.0, (RIM, BORE), "other")))
    assert [(level.name, level.z) for level in part.levels] == [
        ("lower face", -6.0),
        ("upper face", 0.0),
    ]
    assert [(wall.z0, wall.z1) for wall in part.walls] == [(-6.0, 0.0), (-6.0, 0.0)]


def test_edges_of_hubs_pockets_and_holes() -> None:
    rim, bore = circle("rim", 40.0), circle("bore", 6.0, hole=True)
    upper, lower = circle("hub", 12.0), circle("lower hub", 15.0)
    pocket, recess = (circle(name, 5.0, 27j, hole=True) for name in ("pocket", "recess"))
    part = Part(
        (
            Layer(-19.0, -12.0, (lower, bore), "lower hub"),
            Layer(-12.0, -9.5, (rim, recess, bore)),
            Layer(-9.5, -6.25, (rim, bore)),
            Layer(-6.25, 0.0, (rim, pocket, bore)),
            Layer(0.0, 8.0, (upper, bore), "hub"),
        )
    )
    found = {each.boundary.name: each for each in part_edges(part)}
    assert list(found) == [each.name for each in part.boundaries]
    names = {name: layer_name(edge, 1.0) for name, edge in found.items()}
    assert names == {
        "rim": "CUT",
        "bore": "CUT",
        "pocket": "BLIND_6.25",
        "recess": "BLIND_BELOW_2.5",
        "hub": "RAISED_8",
        "lower hub": "RAISED_BELOW_7",
    }
    assert layer_name(found["pocket"], 25.4) == "BLIND_0.246063"
    assert part_layers(["0", *names.values(), "BLIND", "BLINDS", "PITCH_CURVE"]) == {
        *names.values(),
        "BLIND",
    }


@pytest.mark.parametrize(("change", "name"), [
    (("groove_depth = 10", ""), "BLIND"),
    (("groove_depth = 10", "groove_depth = 0.1"), "BLIND_0.1"),
])  # fmt: skip
def test_flanks_of_a_groove_are_blind_with_or_without_a_depth(
    change: tuple[str, str], name: str
) -> None:
    formats = ('formats = ["dxf", "gcode", "stl", "3mf", "csv", "svg", "png"]', 'formats = ["dxf"]')
    part = design("groove", "", change, formats).disc.drawn.part
    kinds = {each.boundary.name: layer_name(each, 1.0) for each in part_edges(part)}
    assert kinds == {"rim": "CUT", "bore": "CUT", "inner flank": name, "outer flank": name}


def test_a_depth_is_written_without_an_exponent() -> None:
    edge = PartEdge(circle("mark", 1.0, hole=True), "sunk", height=1e-5)
    assert layer_name(edge, 1.0) == "BLIND_0.00001"
    assert layer_name(PartEdge(edge.boundary, "sunk", height=12345.0), 1.0) == "BLIND_12345"
    assert layer_name(PartEdge(edge.boundary, "sunk", height=0.1 + 0.2), 1.0) == "BLIND_0.3"


def test_a_hole_below_a_counterbore_is_cut_through() -> None:
    rim, hole, wide = (
        circle("rim", 40.0),
        *(circle(name, radius, 20j, hole=True) for name, radius in (("hole", 3.0), ("wide", 5.0))),
    )
    beside = circle("beside", 3.0, -20j, hole=True)
    part = Part((Layer(-9.0, -4.0, (rim, hole, beside)), Layer(-4.0, 0.0, (rim, wide))))
    assert {each.boundary.name: layer_name(each, 1.0) for each in part_edges(part)} == {
        "rim": "CUT", "hole": "CUT", "beside": "BLIND_BELOW_5", "wide": "BLIND_4",
    }  # fmt: skip


BOUNDARIES = (
    circle("rim", 50.0), circle("bore", 5.0, hole=True), circle("flank", 30.0), circle("hub", 12.0),
)  # fmt: skip


@st.composite
def parts(draw: st.DrawFn) -> Part:
    """Up to four layers, each with the rim and some of the others."""
    count = draw(st.integers(1, 4))
    steps = draw(st.lists(st.integers(1, 400), min_size=count, max_size=count))
    low = -sum(steps[: draw(st.integers(1, count))])
    layers = []
    for k, step in enumerate(steps):
        chosen = draw(st.sets(st.sampled_from(BOUNDARIES[1:]), max_size=3))
        own = (BOUNDARIES[0], *(each for each in BOUNDARIES[1:] if each in chosen))
        # Eighths of a millimetre are exact.
        layers.append(Layer(low / 8.0, (low + step) / 8.0, own, f"layer {k}"))
        low += step
    return Part(tuple(layers))


@given(parts())
def test_twice_is_as_before_with_its_top_at_0(part: Part) -> None:
    again = part.turned_over().turned_over()
    top = part.layers[-1].z1
    assert [(each.z0, each.z1) for each in again.layers] == [
        (each.z0 - top, each.z1 - top) for each in part.layers
    ]
    assert [each.boundaries for each in again.layers] == [each.boundaries for each in part.layers]


@given(parts())
def test_what_lay_down_lies_up(part: Part) -> None:
    turned = part.turned_over()
    assert (turned.layers[-1].z1, turned.thickness) == (0.0, part.thickness)
    low = part.layers[0].z0
    walls = {(wall.boundary.name, low - wall.z1, low - wall.z0) for wall in part.walls}
    assert {(wall.boundary.name, wall.z0, wall.z1) for wall in turned.walls} == walls
    assert set(turned.boundaries) == set(part.boundaries)


# -- spec ------------------------------------------------------------------------------------------
# What a scene states of a part: doors, defaults, keyways against published tables.
#
# `DIN`: DIN 6885-1, August 1968, page 1: width b, and depth t2 in the hub with clearance above the
# key. `FLENDER`: Siemens, FLENDER Standard Couplings, catalogue MD 10.1, 2015, page 15/3, which
# begins at 10 mm. Both have one row more: above 440 mm b is 100 mm, and t2 19.5 or 19.4 mm.


WRONG_LENGTHS: tuple[Any, ...] = (
    0, 0.0, -5.0, math.nan, math.inf, -math.inf, 5e-324, 1e300, 10**400, "3", True, 1j, [1.0], {},
)  # fmt: skip

SPEC = PartSpec(12.0, 20.0, Keyway(6.0, 2.8), 100.0, 5.0)

TEXT = Engraving("Ø8", 4.0, 0.5, 20.0)


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        ({"groove_depth": 12.0}, "groove_depth", "below 12"),
        ({"bore": None}, "keyway", "belongs to a bore"),
        ({"d_shaft": DShaft(18.0)}, "d_shaft", "not both"),
        ({"keyway": None, "d_shaft": DShaft(10.0)}, "d_shaft.across", "above 10 .* below 20"),
        ({"keyway": None, "d_shaft": DShaft(20.0)}, "d_shaft.across", "above 10 .* below 20"),
        ({"set_screw": SetScrew(5.0, 4.0)}, "set_screw", "a hub with a bore"),
        ({"hub": Hub(30.0, 8.0), "set_screw": SetScrew(8.0, 4.0)}, "set_screw.diameter", "below 8"),
        ({"hub": Hub(30.0, 8.0), "set_screw": SetScrew(5.0, 2.5)}, "set_screw.height", "above 2.5"),
        ({"keyway": (6.0, 2.8)}, "keyway", "must be a .Keyway."),
        ({"thickness": None, "groove_depth": None, "pair": Pair(5.0, 30.0)}, "pair", "thickness"),
        ({"pair": Pair(5.0, 20.0)}, "pair.spacer", "above 20"),
        ({"engraving": (TEXT, replace(TEXT, depth=12.0))}, "engraving[2].depth", "below 12"),
        ({"engraving": 21 * (TEXT,)}, "engraving", "at most 20"),
        ({"engraving": ("cam",)}, "engraving", "texts"),
    ],
)
def test_what_does_not_go_together(changes: dict[str, Any], key: str, message: str) -> None:
    with refused(f"part.{key}", message):
        replace(SPEC, **changes)


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
def test_diameter_of_a_bore(value: Any) -> None:
    with refused("part.bore"):
        bore_boundary(value, None)


@pytest.mark.parametrize("heights", [(0.0, -1.0), (-1.0, -1.5)])
def test_walls_reach_upwards(heights: tuple[float, float]) -> None:
    with refused("part"):
        Wall(bore_boundary(20.0, None), *heights)


def test_only_round_outlines_have_parallels_of_their_own() -> None:
    keyed = bore_boundary(20.0, Keyway(6.0, 2.8))
    assert keyed.offset(3.0).round_radius == bore_boundary(20.0, None).offset(3.0).round_radius == 7
    with pytest.raises(GeometryError, match="is not round"):
        replace(keyed, core=None).offset(3.0)
    with pytest.raises(GeometryError, match="above 0"):
        keyed.offset(10.0)


VALUES: dict[str, tuple[type, dict[str, float]]] = {
    "part.keyway": (Keyway, {"width": 6.0, "depth": 2.8}),
    "part.d_shaft": (DShaft, {"across": 17.0}),
    "part.hub": (Hub, {"diameter": 40.0, "height": 6.0}),
    "part.set_screw": (SetScrew, {"diameter": 4.0, "height": 3.0}),
    "part.mark": (Mark, {"radius": 25.0, "width": 2.0, "depth": 1.0}),
    "part.bolt_circle.counterbore": (Counterbore, {"diameter": 6.0, "depth": 3.0}),
    "part.holes": (Holes, {"count": 3, "circle": 40.0, "hole": 5.0}),
    "part.pair": (Pair, {"gap": 7.0, "spacer": 36.0}),
    "part.chamfers": (Chamfer, {"width": 1.0}),
    "part.engraving": (Engraving, {"height": 4.0, "depth": 0.5, "radius": 20.0}),
}


@pytest.mark.parametrize("table", VALUES)
def test_each_value_is_checked_under_its_key(table: str) -> None:
    kind, values = VALUES[table]
    given: dict[str, Any] = {"text": "a", **values} if kind is Engraving else values
    made = kind(**given)
    assert getattr(made, "angle", 0.0) == 0.0
    for name in values:
        with refused(f"{table}.{name}"):
            kind(**{**given, name: -1})
    if hasattr(made, "angle"):
        with refused(f"{table}.angle"):
            kind(**{**given, "angle": 6.3})


DIN = {
    "up to": (
        8, 10, 12, 17, 22, 30, 38, 44, 50, 58, 65, 75, 85, 95, 110, 130, 150, 170, 200, 230, 260,
        290, 330, 380, 440,
    ),
    "b": (
        2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56, 63, 70, 80,
        90,
    ),
    "t2": (
        1, 1.4, 1.8, 2.3, 2.8, 3.3, 3.3, 3.3, 3.8, 4.3, 4.4, 4.9, 5.4, 5.4, 6.4, 7.4, 8.4, 9.4,
        10.4, 11.4, 12.4, 12.4, 14.4, 15.4, 17.4,
    ),
}  # fmt: skip

FLENDER = (
    (10, 3, 1.4), (12, 4, 1.8), (17, 5, 2.3), (22, 6, 2.8), (30, 8, 3.3), (38, 10, 3.3),
    (44, 12, 3.3), (50, 14, 3.8), (58, 16, 4.3), (65, 18, 4.4), (75, 20, 4.9), (85, 22, 5.4),
    (95, 25, 5.4), (110, 28, 6.4), (130, 32, 7.4), (150, 36, 8.4), (170, 40, 9.4), (200, 45, 10.4),
    (230, 50, 11.4), (260, 56, 12.4), (290, 63, 12.4), (330, 70, 14.4), (380, 80, 15.4),
    (440, 90, 17.4),
)  # fmt: skip


def test_the_table_is_that_of_the_standard() -> None:
    assert list(ROWS) == list(map(KeywayRow._make, zip(*DIN.values(), strict=True)))


def test_the_table_is_that_of_a_maker_of_couplings() -> None:
    assert list(ROWS[1:]) == [KeywayRow(*row) for row in FLENDER]


@given(st.floats(SMALLEST, ROWS[-1].largest, exclude_min=True))
@attack
def test_each_bore_has_one_row(bore: float) -> None:
    found = din_6885_1(bore)
    assert bore <= found.largest
    assert all(row.largest < bore for row in ROWS if row.largest < found.largest)


@pytest.mark.parametrize("bore", [6.0, 5.0, 440.1, 500.0])
def test_bores_without_a_row(bore: float) -> None:
    with refused("part.keyway.standard", "above 6 mm, up to 440 mm"):
        din_6885_1(bore)


# -- materials -------------------------------------------------------------------------------------
#


HARDNESS = {"steel": 180, "steel-tempered": 300, "cast-iron": 200, "cast-iron-ductile": 220}
"""Of the rows whose limit follows from it by ISO 6336-5, sigma_Hlim = A x + B, quality MQ."""


@pytest.mark.parametrize("name", MATERIALS)
def test_a_material_has_a_source_and_is_one_that_there_can_be(name: str) -> None:
    """Positive definite elasticity; no lighter than water, no heavier than lead; a limit below the
    static one of the best bearing steel, 4000 MPa (ISO 76, line contact). A scene can name it."""
    material = find_material(name)
    assert material.name == name
    assert material.title
    assert material.source
    assert material.modulus > 0.0
    assert 0.0 < material.poisson < 0.5
    assert 1e-9 < material.density < 11.3e-9
    assert material.pressure is None or 0.0 < material.pressure < 4000.0
    assert re.search(schema()["$defs"]["material"]["pattern"], name)


@pytest.mark.parametrize(("name", "hardness"), HARDNESS.items())
def test_a_limit_is_the_one_of_its_hardness(name: str, hardness: int) -> None:
    """To half a unit, the last digit of the row."""
    material = find_material(name)
    found = re.search(r"([\d.]+) x \+ (\d+)", material.source)
    assert found is not None
    assert material.pressure is not None
    assert str(hardness) in material.title
    assert abs(float(found[1]) * hardness + float(found[2]) - material.pressure) <= 0.5


def test_bronze_on_steel_has_the_modulus_of_the_standard() -> None:
    """DIN 3996 prints E_red = 140144 N/mm^2 for CuSn12-C-GZ on steel, twice the contact modulus."""
    compliance = sum(
        (1.0 - each.poisson**2) / each.modulus
        for each in (find_material("bronze"), find_material("steel"))
    )
    assert round(2.0 / compliance) == 140144


@pytest.mark.parametrize(
    ("name", "meant"),
    [("steel-harden", "steel-hardened"), ("Bronze", "bronze"), ("aluminum", "aluminium")],
)
def test_a_misspelt_name_is_refused_with_the_one_meant(name: str, meant: str) -> None:
    with pytest.raises(GeometryError, match=f"did you mean {meant}") as caught:
        find_material(name, "cam_material")
    assert (caught.value.key, caught.value.value) == ("cam_material", name)


def test_a_name_like_no_other_is_refused_with_all_there_are() -> None:
    with pytest.raises(GeometryError) as caught:
        find_material("qqqq")
    assert "did you mean" not in caught.value.message
    assert all(name in caught.value.message for name in MATERIALS)


# Mass, moments and walls --------------------------------------------------------------------------


SCENES = ("plate_translating", "groove", "ring", "cut_lobe", "conjugate_lever", "flat_rocker")


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("eccentricity", [0.0, 5.0, 30.0])
def test_an_eccentric_disc_is_a_cylinder(eccentricity: float, rotation: int) -> None:
    """J = m r^2/2 about its own axis, m (3 r^2 + h^2)/12 across it; Steiner about the cam axis."""
    path = eccentric(eccentricity, 40.0, rotation, guide=0.7)
    found = Solid.from_part(
        Part((Layer(-9.0, 0.0, (CurveBoundary("outline", hole=False, path=path),)),))
    )
    volume = math.pi * 40.0**2 * 9.0
    across = volume * (3.0 * 40.0**2 + 9.0**2) / 12.0
    assert found.volume == pytest.approx(volume, rel=1e-12)
    centre = [eccentricity * math.cos(0.7), eccentricity * math.sin(0.7), -4.5]
    assert np.allclose(found.centre, centre, rtol=0.0, atol=1e-11)
    expected = np.diag([across, across, 0.5 * volume * 40.0**2])
    assert np.allclose(found.inertia, expected, rtol=0.0, atol=1e-11 * volume * 70.0**2)
    assert found.axial == pytest.approx(volume * (0.5 * 40.0**2 + eccentricity**2), rel=1e-12)
    assert found.share < 1e-9
    assert found.centre_error < 1e-7
    assert radii(path).highest.value == pytest.approx(40.0 + eccentricity, rel=1e-15)


def test_a_stepped_ring_with_a_pocket_off_the_axis() -> None:
    """Hub, flange and a blind hole: cylinders, added up with Steiner's terms by hand."""
    bore = circle("bore", 6.0, hole=True)
    flange, hub = circle("outline", 40.0), circle("hub", 15.0)
    pocket = circle("pocket", 4.0, 25.0 + 10.0j, hole=True)
    part = Part(
        (
            Layer(-10.0, -3.0, (flange, bore)),
            Layer(-3.0, 0.0, (flange, pocket, bore)),
            Layer(0.0, 12.0, (hub, bore), "hub"),
        )
    )
    cylinders = [
        (1.0, 40.0, 0j, -10.0, 0.0), (1.0, 15.0, 0j, 0.0, 12.0),
        (-1.0, 6.0, 0j, -10.0, 12.0), (-1.0, 4.0, 25.0 + 10.0j, -3.0, 0.0),
    ]  # fmt: skip
    volume, first, about = 0.0, np.zeros(3), np.zeros((3, 3))
    for sign, radius, at, low, high in cylinders:
        own = sign * math.pi * radius**2 * (high - low)
        place = np.array([at.real, at.imag, 0.5 * (low + high)])
        across = own * (3.0 * radius**2 + (high - low) ** 2) / 12.0
        volume, first = volume + own, first + own * place
        about += np.diag([across, across, 0.5 * own * radius**2]) + shifted(own, place)
    found = Solid.from_part(part)
    assert found.volume == pytest.approx(volume, rel=1e-14)
    assert np.allclose(found.centre, first / volume, rtol=0.0, atol=1e-13)
    about -= shifted(volume, first / volume)
    assert np.allclose(found.inertia, about, rtol=0.0, atol=1e-13 * volume * 40.0**2)
    assert largest_diameter(part) == (80.0, None)
    areas = [math.pi * each for each in (40.0**2 - 36.0, 40.0**2 - 52.0, 15.0**2 - 36.0)]
    assert [section_area(each) for each in part.layers] == pytest.approx(areas, rel=1e-14)


def shifted(volume: float, place: FloatArray) -> FloatArray:
    """Steiner's term of a volume at `place` (3,): (3, 3)."""
    found: FloatArray = volume * (place @ place * np.eye(3) - np.outer(place, place))
    return found


def seconds(contour: Contour) -> SecondMoments:
    return ExactBoundary("outline", hole=False, exact=contour).second_moments(1e-12)


places = st.complex_numbers(max_magnitude=60.0, allow_nan=False, allow_infinity=False)


@settings(max_examples=40, deadline=None)
@given(places, st.floats(0.5, 40.0), st.floats(0.1, 6.2), st.floats(-3.0, 3.0))
def test_second_moments_of_a_segment_are_those_of_its_circle_less_the_rest(
    centre: complex, radius: float, sweep: float, first: float
) -> None:
    """An arc and its chord, and the other arc with the same chord, make up the circle, for which
    the integral of |z|^2 is A (r^2/2 + |c|^2), that of z^2 is A c^2.
    """
    turned = np.exp(1j * np.array([first, first + sweep]))
    ends = np.asarray(centre + radius * turned, dtype=np.complex128)
    centres = np.array([centre, 0j])
    one = seconds(Contour(ends, np.array([sweep, 0.0]), centres))
    rest = np.array([2.0 * math.pi - sweep, 0.0])
    other = seconds(Contour(ends[::-1], rest, centres))
    area = math.pi * radius * radius
    room = 1e-13 * area * (radius + abs(centre)) ** 2 + 1e-13 * radius * (radius + abs(centre)) ** 3
    expected = area * (0.5 * radius * radius + abs(centre) ** 2)
    assert abs(one.polar + other.polar - expected) <= room
    assert abs(one.square + other.square - area * centre**2) <= room


def test_second_moments_of_a_rectangle() -> None:
    found = seconds(polyline(np.array([1.0 + 2.0j, 4.0 + 2.0j, 4.0 + 7.0j, 1.0 + 7.0j])))
    xx, yy = (64.0 - 1.0) / 3.0 * 5.0, (343.0 - 8.0) / 3.0 * 3.0
    assert found.polar == pytest.approx(xx + yy, rel=1e-14)
    xy = 0.25 * (16.0 - 1.0) * (49.0 - 4.0)
    assert found.square == pytest.approx(complex(xx - yy, 2.0 * xy), rel=1e-14)
    assert found.scaled(-1.0).counter_clockwise() == found


def discs(name: str) -> Iterator[Part]:
    return (disc.drawn.part for disc in design(name, "").discs)


@pytest.mark.parametrize("scene", SCENES)
def test_the_body_of_the_writers_has_the_same_mass_properties(scene: str) -> None:
    """Its vertices are within t of the boundaries: volumes differ by t times the walls, moments of
    inertia by that times the square of the largest radius."""
    import trimesh

    from camgeo_export.solid.prism import body

    tolerance = 2e-3
    for part in discs(scene):
        found = Solid.from_part(part)
        made = body(part, tolerance, lambda x: x)
        mesh = trimesh.Trimesh(made.vertices, made.triangles, process=False)
        walls = part.thickness * sum(each.polyline(0.1).contour.length for each in part.boundaries)
        room = 1.1 * tolerance * walls
        largest = 0.5 * largest_diameter(part)[0]
        volume, span = found.volume, largest + part.thickness
        assert abs(mesh.volume - volume) <= room
        centre = found.centre - [0.0, 0.0, part.layers[0].z0]  # bodies stand on the plane z = 0
        assert np.all(abs(mesh.center_mass - centre) <= 2.0 * room * span / volume)
        assert np.all(abs(mesh.moment_inertia - found.inertia) <= 8.0 * room * span**2)
        reach = float(np.max(np.hypot(*made.vertices.T[:2])))
        assert abs(reach - largest) <= tolerance
        moments = disc_moments(part, 1.0, 1e-12)
        assert moments.area == pytest.approx(volume, rel=1e-9)
        off = moments.first / moments.area - complex(*found.centre[:2])
        assert abs(off) <= 1e-8 * largest


@pytest.mark.parametrize(("distance", "sweep", "expected"), [
    (8.0, 2.0, 38.0), (8.0, 0.5, None), (-8.0, -2.0, 38.0), (0.0, 1.0, 30.0),
])  # fmt: skip
def test_the_farthest_point_of_an_arc(
    distance: float, sweep: float, expected: float | None
) -> None:
    """About a centre 30 mm away, once over the point behind it and once short of that."""
    normal = np.exp(-1j) if distance >= 0.0 else -np.exp(1j)
    pivot = Pivot(30.0 + 0j, distance, complex(normal), sweep, 0.0, 0.25)
    found = radii(Path((pivot,))).highest
    ends = max(abs(pivot.start), abs(pivot.end))
    assert found.value == pytest.approx(ends if expected is None else expected, rel=1e-15)
    assert found.place == 0.25


def test_a_part_without_heights_has_no_body() -> None:
    part = Part((Layer(0.0, 0.0, (circle("outline", 40.0),)),))
    with pytest.raises(GeometryError, match="thickness"):
        Solid.from_part(part)


CIRCLE = math.pi / 2.0
"""A direction in which the inner flank dwells at 32 mm."""


@pytest.mark.parametrize(
    ("spec", "names", "thickness", "usual"),
    [
        (PartSpec(bore=60.0), ("outline", "bore"), 2.0, 6.0),
        (PartSpec(bore=20.0, hub=Hub(26.0, 5.0)), ("hub", "bore"), 3.0, 2.0),
        (PartSpec(bolt_circle=Holes(2, 12.0, 8.0)), ("bolt hole 1", "bolt hole 2"), 4.0, 0.8),
        (PartSpec(lightening_holes=Holes(1, 50.0, 8.0, CIRCLE)), None, 3.0, 0.8),
        (PartSpec(rim=140.0, groove_depth=4.0, bore=50.0), ("inner flank", "bore"), 7.0, 5.0),
    ],
)
def test_walls_of_circles(
    spec: PartSpec, names: tuple[str, str] | None, thickness: float, usual: float
) -> None:
    part = made(Contact.INNER if spec.rim is None else Contact.GROOVE, spec)
    least, found = Web.thinnest_webs(part)
    assert found is not None
    assert least is not None
    assert least.thickness == found.thickness
    # A groove's outer flank is a hole around the bore, so circles about both meet.
    assert Web.surely_thick(part) == (thickness > usual and spec.rim is None)
    assert names in (None, (found.one, found.other))
    assert found.thickness == pytest.approx(thickness, abs=0.01)
    assert found.usual == pytest.approx(usual)


def test_a_keyway_towards_the_dwell() -> None:
    """From the corners of the slot to a circle of 32 mm; near the limit it is that exact."""
    spec = PartSpec(bore=50.0, keyway=Keyway(8.0, 3.0, CIRCLE))
    wall = 32.0 - math.hypot(28.0, 4.0)
    for limit in (wall - 1e-5, wall + 1e-5):
        found = Web.thinnest_webs(made(Contact.INNER, spec), limit)[0]
        assert found is not None
        assert (found.thickness < limit) == (wall < limit)
        assert found.thickness == pytest.approx(wall, abs=1e-6)
        assert min(abs(found.place - corner) for corner in (4.0 + 28.0j, -4.0 + 28.0j)) < 1e-9


def test_an_exact_wall_takes_no_fine_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    """A steep flank has 180,000 chords within 1e-4 mm, which would show a place for the eye."""
    asked = []
    distance_fit = CurveBoundary.distance_fit

    def counted(self: CurveBoundary, tolerance: float) -> Fit:
        asked.append(tolerance)
        return distance_fit(self, tolerance)

    monkeypatch.setattr(CurveBoundary, "distance_fit", counted)
    found = Web.thinnest_webs(made(Contact.INNER, PartSpec(bore=60.0)))[0]
    assert found is not None
    assert found.thickness == pytest.approx(2.0, abs=1e-12)
    assert abs(found.place) == pytest.approx(30.0)
    assert min(asked) == TOLERANCES[0]


def test_the_thinnest_wall_is_not_always_thin_beside_its_hole() -> None:
    """A wall of 3 mm beside a bore of 20 mm is more than usual, one of 2 mm beside 8 mm too."""
    spec = PartSpec(bore=20.0, hub=Hub(25.0, 5.0), lightening_holes=Holes(1, 52.4, 8.0, CIRCLE))
    part = made(Contact.INNER, spec)
    least, relative = Web.thinnest_webs(part)
    assert relative is not None
    assert least is not None
    assert (relative.one, relative.thickness) == ("hub", 2.5)
    assert Web.thinnest_webs(part, 1.0)[0] == least
    assert least.other == "lightening hole 1"
    assert least.thickness == pytest.approx(1.8, abs=0.01)


def test_beside_a_flank_alone_nothing_is_usual() -> None:
    found = Web.thinnest_webs(made(Contact.OUTER, PartSpec(rim=140.0)))[0]
    assert found is not None
    assert (found.one, found.other, found.usual) == ("rim", "outline", 0.0)
    assert found.thickness == pytest.approx(7.0, abs=0.01)
    assert Web.thinnest_webs(made(Contact.OUTER, PartSpec(rim=140.0)))[1] is None
    assert Web.thinnest_webs(made(Contact.INNER, PartSpec()))[0] is None


@given(st.sampled_from(list(FLANKS)), specs(), st.booleans())
@attack
def test_no_wall_of_a_random_part_is_thinner(
    contact: Contact, spec: PartSpec, limited: bool
) -> None:
    """Of all pairs of boundaries between which there is material in a layer."""
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    limit = 1.0 if limited else None
    found, beside = Web.thinnest_webs(part, limit)[0], Web.thinnest_webs(part)[1]
    walls = list(_walls(part))
    assert (found is None) == (not walls)
    if found is None:
        return
    assert not Web.surely_thick(part, 1.0) or found.thickness >= 1.0
    assert found.thickness == pytest.approx(min(wall for wall, _ in walls), abs=0.05)
    assert (beside is None) == (not any(usual for _, usual in walls))
    if beside is None:
        return
    assert not Web.surely_thick(part) or beside.thickness >= beside.usual
    off = 0.05  # of the polygons
    relative = beside.thickness / beside.usual
    assert relative <= min((wall + off) / usual for wall, usual in walls if usual)
    assert relative >= min((wall - off) / usual for wall, usual in walls if usual)


def test_walls_of_random_scenes_are_those_of_shapely() -> None:
    assert [missed for _, missed in misses(3, 2026)] == [[]] * 3


def _walls(part: Part) -> list[tuple[float, float]]:
    """Distances of polygons [mm], and the usual ones."""
    found = []
    areas = {each.name: polygon_of(each, 1e-2) for each in part.boundaries}
    for layer in part.layers:
        for one, other in combinations(layer.boundaries, 2):
            a, b = areas[one.name], areas[other.name]
            nested = a.contains(b) if not one.hole else b.contains(a) if not other.hole else False
            apart = one.hole and other.hole and a.disjoint(b)
            solid, hole = (one, other) if not one.hole else (other, one)
            if not (apart or (nested and not solid.hole and hole.hole)):
                continue
            sizes = [
                2.0 * math.sqrt(each.arcs(1e-2, "fast").contour.area / math.pi)
                for each in (one, other)
                if each.hole and each.name not in ("outline", "outer flank")
            ]
            found.append((a.exterior.distance(b.exterior), SHARE * max(sizes, default=0.0)))
    return found
