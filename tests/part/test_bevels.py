"""Chamfers of parts: closed forms of their bodies, which edges have one, and what has no room."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.contour.contour import Contour
from camgeo.part.bevels import bevelled
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.mass import disc_moments, solid
from camgeo.part.part import Bevel, Layer, Part, edges_of
from camgeo.part.spec import Chamfer, Chamfers, Counterbore, DShaft, Holes, Hub, Keyway, PartSpec
from tests.part.parts import DISC, circle, made, refused
from tests.scene.scenes import PLATE, loaded
from tests.strategies import attack


def edged(contact: Contact, spec: PartSpec, **chamfers: Chamfer) -> Part:
    return made(contact, replace(spec, chamfers=Chamfers(**chamfers)))


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
    body = solid(part)
    around = [_frustum(radius, radius - of_rim, -of_rim), _cylinder(radius, of_rim - 10.0,
              -of_rim), _frustum(radius - of_rim, radius, -10.0, of_rim)]  # fmt: skip
    within = [_cylinder(8.0, -10.0, -of_bore), _frustum(8.0, 8.0 + of_bore, -of_bore)]
    volume = sum(each[0] for each in around) - sum(each[0] for each in within)
    height = sum(each[1] for each in around) - sum(each[1] for each in within)
    polar = sum(each[2] for each in around) - sum(
        each[2] + each[0] * aside**2 for each in within
    )  # fmt: skip
    assert body.volume == pytest.approx(volume, rel=1e-12)
    assert body.centre[2] * volume == pytest.approx(height, rel=1e-11)
    assert body.axial == pytest.approx(polar, rel=1e-11)
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
    assert [each.boundary for each in edges_of(part)] == [
        each.boundary for each in edges_of(part.sharp)
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
    assert areas[1] == pytest.approx(grown, rel=1e-6)
    assert fits[1].length == pytest.approx(fits[0].length + sign * 4.0 * math.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("contact", "spec", "chamfers", "key", "message"),
    [
        (Contact.INNER, DISC, {"outline": Chamfer(5.0)}, "outline.width", "less than 5 mm"),
        (Contact.INNER, replace(DISC, bore=40.0),
         {"outline": Chamfer(9.9, "upper"), "bore": Chamfer(4.0)}, "outline.width",
         "comes to the bore"),
        (Contact.GROOVE, DISC, {"outline": Chamfer(4.0)}, "outline.width", "less than 4 mm"),
        (Contact.GROOVE, DISC, {"outline": Chamfer(1.0, "lower")}, "outline", "lower side"),
        (Contact.INNER, replace(DISC, keyway=Keyway(6.0, 2.8), hub=Hub(29.0, 20.0)),
         {"bore": Chamfer(1.0)}, "bore.width", "comes to the hub"),
        (Contact.INNER, replace(DISC, hub=Hub(24.0, 20.0)),
         {"hub": Chamfer(1.0), "bore": Chamfer(1.0)}, "bore.width", "comes to the hub, 2 mm"),
        (Contact.INNER, replace(DISC, hub=Hub(60.0, 3.0)), {"outline": Chamfer(2.5)},
         "outline.width", "comes to the hub"),
        (Contact.INNER, replace(DISC, thickness=80.0, bore=None), {"outline": Chamfer(32.0)},
         "outline.width", "smallest radius of the outline where it goes round material"),
        (Contact.INNER, DISC, {"hub": Chamfer(1.0)}, "hub", "no such edge"),
    ],
)  # fmt: skip
def test_what_has_no_room_is_refused_with_its_key(
    contact: Contact, spec: PartSpec, chamfers: dict[str, Chamfer], key: str, message: str
) -> None:
    with refused(f"part.chamfers.{key}", message):
        edged(contact, spec, **chamfers)


def test_chamfers_at_different_heights_do_not_meet() -> None:
    """A hole 1.5 mm beside the bore, each with a chamfer of 1 mm."""
    spec = replace(DISC, bolt_circle=Holes(1, 27.0, 4.0))
    part = edged(Contact.INNER, spec, bore=Chamfer(1.0, "upper"), bolt_circle=Chamfer(1.0, "lower"))
    sharp = edged(Contact.INNER, spec)
    # By Pappus' theorem: a triangle of 1 mm by 1 mm about each axis, its centroid a third outside.
    cut = math.pi * (10.0 + 1.0 / 3.0) + math.pi * (2.0 + 1.0 / 3.0)
    assert solid(part).volume == pytest.approx(solid(sharp).volume - cut, rel=1e-12)
    with pytest.raises(GeometryError, match=r"comes to the bolt hole 1, 1\.5 mm"):
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
    removed = solid(part.sharp).volume - solid(part).volume
    assert removed == pytest.approx(wanted, abs=1e-11 * solid(part).volume)


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
    assert caught.value.key == "part.chamfers.hub.width"
    assert caught.value.value == "3"


def test_a_chamfer_needs_heights() -> None:
    with refused("part.thickness"):
        edged(Contact.INNER, PartSpec(bore=20.0), outline=Chamfer(1.0))


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
