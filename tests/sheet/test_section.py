"""The views: section and chamfers of parts of circles, dashes, and edges hidden in part."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

import camgeo
from camgeo.cam.cam import Contact
from camgeo.design.product import Product
from camgeo.geometry.contour.contour import Contour
from camgeo.part.assembly import bevelled as part_with
from camgeo.part.assembly import bore_boundary
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import Chamfer, Chamfers, Keyway, PartSpec
from camgeo.pictures.sheet.marks import Chain, Hatched, Label, Mark, line
from camgeo.pictures.sheet.section import (
    COARSE,
    Edge,
    Shape,
    bevelled,
    chamfer_corners,
    edges_above,
    section,
)
from camgeo.pictures.sheet.sheet import (
    DASH_DOT,
    DASH_DOTS,
    dashed,
    dashed_stretch,
    in_dashes,
)
from camgeo_export.drawing.writer import hatching
from tests.part.parts import FLANKS, circle, made_or_refused, specs
from tests.strategies import attack


def cut(*layers: Layer) -> list[Mark]:
    return section(Shape.from_part(Part(layers), 0.01, "fast"))


def area(marks: list[Mark]) -> float:
    """Of the cut faces [mm^2]."""
    faces = [each.corners for each in marks if isinstance(each, Hatched)]
    return sum(np.ptp(each.real) * np.ptp(each.imag) for each in faces)


def lines(marks: list[Mark], layer: str) -> set[tuple[complex, complex]]:
    """The lines of a layer, to a thousandth."""
    return {
        (complex(np.round(m.vertices[0], 3)), complex(np.round(m.vertices[1], 3)))
        for m in marks
        if isinstance(m, Chain) and m.layer == layer
    }


OUTLINE: Boundary = circle("outline", 40.0)
BORE: Boundary = circle("bore", 8.0, hole=True)
HUB: Boundary = circle("hub", 15.0)


def test_a_disc_with_a_hub() -> None:
    """Faces, and every edge: those of the bore's rims are behind the plane."""
    marks = cut(Layer(-10.0, 0.0, (OUTLINE, BORE)), Layer(0.0, 12.0, (HUB, BORE), "hub"))
    assert area(marks) == pytest.approx(10.0 * 64.0 + 12.0 * 14.0)
    across = {each for each in lines(marks, "SECTION") if each[0].imag == each[1].imag}
    assert across == {
        (complex(0, y), complex(end, y)) for y, end in ((40, 10), (-40, 10), (8, 22), (-8, 22))
    } | {(complex(10, y), complex(22, y)) for y in (15, -15)}
    assert lines(marks, "EDGES") == {(0 - 8j, 0 + 8j), (22 - 8j, 22 + 8j)}


def test_material_that_continues_through_layers_has_no_line_between_them() -> None:
    whole = cut(Layer(-10.0, 0.0, (OUTLINE, BORE)))
    halves = cut(Layer(-10.0, -4.0, (OUTLINE, BORE)), Layer(-4.0, 0.0, (OUTLINE, BORE), "groove"))
    assert area(whole) == pytest.approx(area(halves))
    for layer in ("SECTION", "EDGES"):
        assert lines(whole, layer) == lines(halves, layer)


@pytest.mark.parametrize(("angle", "seen"), [(0.0, True), (math.pi, False)])
def test_a_keyway_is_seen_behind_the_plane_alone(angle: float, seen: bool) -> None:
    bore = bore_boundary(16.0, Keyway(5.0, 2.3, angle))
    found = lines(cut(Layer(-10.0, 0.0, (OUTLINE, bore))), "EDGES")
    sides = {(complex(0, y), complex(10, y)) for y in (2.5, -2.5)}
    assert (found & sides == sides) is seen


def test_what_lies_behind_is_seen_beyond_the_cut() -> None:
    """A disc about another centre is larger behind the plane than in it."""
    off = circle("outline", 30.0, 18.0 + 0j)
    marks = cut(Layer(-5.0, 0.0, (off,)))
    assert area(marks) == pytest.approx(5.0 * 48.0, rel=2.0 * COARSE)
    found = lines(marks, "EDGES")
    assert (0 + 30j, 5 + 30j) in found
    assert (0 - 30j, 5 - 30j) in found


@pytest.mark.parametrize("corners", [
    [1 + 2j, 9 + 2j, 9 + 30j, 1 + 30j],
    [1 + 0j, 9 + 0j, 10 + 1j, 10 + 9j, 9 + 10j, 0 + 10j, 0 + 1j],
])  # fmt: skip
def test_hatching_fills_its_face_at_its_distance(corners: list[complex]) -> None:
    """Of a face with and without its corners."""
    polygon = Hatched(np.array(corners)).corners
    found = np.array(list(hatching(Hatched(polygon), 0.7)))
    assert np.diff(found, axis=1)[:, 0] == pytest.approx(np.ptp(found.real, axis=1) * (1 + 1j))
    rises = np.sort(found[:, 0].imag - found[:, 0].real)
    assert np.allclose(np.diff(rises), 0.7 * math.sqrt(2.0))
    length = float(np.sum(np.abs(np.diff(found, axis=1))))
    assert length * 0.7 == pytest.approx(abs(Contour.polygon(polygon).area), rel=0.02)
    sides = np.roll(polygon, -1) - polygon
    away = ((found.ravel()[:, None] - polygon) * np.conj(sides)).imag
    assert np.all(away >= -1e-9)


@given(st.sampled_from(list(FLANKS)), specs())
@settings(attack, max_examples=15)
def test_random_parts_are_cut_as_their_polygons_are(contact: Contact, spec: PartSpec) -> None:
    """Any layers: their material on the plane by polygons, and the edges below others."""
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    shape = Shape.from_part(part, 0.01, "fast")
    expected = 0.0
    for layer in part.layers:
        inside: BaseGeometry = Polygon()
        for contour in shape.contours(layer):
            points = contour.points(1e-3)
            ring = Polygon(np.column_stack((points.real, points.imag)))
            inside = inside.symmetric_difference(ring)
        plane = LineString([(0.0, -200.0), (0.0, 200.0)])
        expected += (layer.z1 - layer.z0) * inside.intersection(plane).length
    assert area(section(shape)) == pytest.approx(expected, rel=1e-2)
    top = part.layers[-1]
    assert not any(edge.hidden for edge in shape.edges if edge.boundary in top.boundaries)


CHAMFERS = Chamfers(outline=Chamfer(1.0), bore=Chamfer(0.5, "upper"), hub=Chamfer(2.0))

PART = part_with(
    Part((Layer(-10.0, 0.0, (OUTLINE, BORE)), Layer(0.0, 12.0, (HUB, BORE), "hub"))), CHAMFERS, 0.01
)


def drawn() -> tuple[Shape, list[Mark]]:
    shape = Shape.from_part(PART, 0.01, "fast")
    return shape, bevelled(section(shape), shape)


def test_the_section_lacks_the_corners() -> None:
    """Of the faces beside a cylinder: a triangle for each chamfer, above and below the axis."""
    _, marks = drawn()
    faces = [each.corners for each in marks if isinstance(each, Hatched)]
    area = sum(abs(Contour.polygon(each).area) for each in faces)
    sharp = 10.0 * 64.0 + 12.0 * 14.0
    assert area == pytest.approx(sharp - 2.0 * (2.0 * 0.5 + 0.125 + 2.0), abs=0.02)


def test_edges_of_the_section() -> None:
    _, marks = drawn()
    cut = lines(marks, "SECTION")
    for y in (1.0, -1.0):
        assert {complex(10, 39 * y), complex(9, 40 * y)} in [set(each) for each in cut]
        assert {complex(22, 8.5 * y), complex(21.5, 8 * y)} in [set(each) for each in cut]
        assert {complex(22, 13 * y), complex(20, 15 * y)} in [set(each) for each in cut]
        assert {complex(1, 40 * y), complex(9, 40 * y)} in [set(each) for each in cut]
    seen = [set(each) for each in lines(marks, "EDGES")]
    assert {21.5 - 8j, 21.5 + 8j} in seen  # the edge between bore and chamfer, behind the plane
    ends = [end for each in cut for end in each]
    for corner in chamfer_corners(drawn()[0]):
        assert not any(abs(end - corner.sharp) < 0.2 for end in ends)


def test_mitres_join_the_corners_of_a_keyway() -> None:
    """Seen from above, from corner to corner; beside the circle they are bent."""
    wall = bore_boundary(20.0, Keyway(6.0, 2.8))
    part = Part((Layer(-10.0, 0.0, (OUTLINE, wall)),))
    part = part_with(part, Chamfers(bore=Chamfer(2.0, "upper")), 0.01)
    chains = list(edges_above(Shape.from_part(part, 1e-3, "fast"), 1e-3, "fast"))
    mitres = [each.vertices for each in chains if not each.closed]
    ends = {(complex(each[0]), complex(each[-1])) for each in mitres}
    edge = wall.inset(2.0, "edge").exact
    assert ends == set(zip(wall.exact.vertices.tolist(), edge.vertices.tolist(), strict=True))
    straight, bent = (
        [each for each in mitres if np.all(each[:1].real > 10.0) == inner]
        for inner in (True, False)
    )
    assert (len(straight), len(bent)) == (2, 2)
    for each in bent:  # u^2 = r^2 - p^2 + 2 d (r - p)
        assert len(each) > 3
        away = np.abs(each.imag) - 3.0
        assert np.allclose(each.real**2, 91.0 + 14.0 * away, rtol=1e-12, atol=0.0)


# Front view ---------------------------------------------------------------------------------------
# The front view: dashes of curves and lines, and the edges of which a part is hidden.


def length(chain: Chain) -> float:
    """Of a chain [mm]."""
    chord = np.abs(np.diff(chain.vertices))
    half = 0.5 * np.abs(chain.sweeps[:-1])
    return float(np.sum(chord * np.where(half == 0.0, 1.0, half / np.sin(np.where(half, half, 1)))))


@pytest.mark.parametrize("pattern", [DASH_DOT, DASH_DOTS])
@pytest.mark.parametrize("scale", [0.01, 1.0, 50.0])
def test_dashes_lie_on_the_curve_in_their_proportion(
    pattern: tuple[float, ...], scale: float
) -> None:
    """A whole number of patterns, in pieces of any length: a circle of many arcs."""
    radius = 20.0 / scale
    circle = Contour.circle(radius).split(0.01)
    found = list(dashed(circle, scale, "PITCH_CURVE", pattern))
    assert len(found) % (len(pattern) / 2) == 0
    share = sum(pattern[::2]) / sum(pattern)
    assert sum(map(length, found)) == pytest.approx(share * circle.length, rel=1e-9)
    for each in found:
        assert np.allclose(np.abs(each.vertices), radius, rtol=1e-12)


def test_a_line_begins_and_ends_with_a_dash() -> None:
    whole = line(1 + 1j, 1 + 101j, "CENTRE")
    found = [each for each in in_dashes([whole], 1.0) if isinstance(each, Chain)]
    assert found[0].vertices[0] == 1 + 1j
    assert found[-1].vertices[1] == pytest.approx(1 + 101j)
    assert length(found[0]) == pytest.approx(length(found[-1]))
    assert all(each.layer == "CENTRE" for each in found)


def test_short_lines_and_other_layers_stay_as_they_are() -> None:
    marks: list[Mark] = [line(0j, 5 + 0j, "CENTRE"), line(0j, 500 + 0j, "OUTLINE"), Label("A", 0j)]
    assert list(in_dashes(marks, 1.0)) == marks


@pytest.mark.parametrize("sweep", [0.0, 0.3, -2.0])
def test_a_stretch_begins_and_ends_with_a_dash(sweep: float) -> None:
    """Of lines and arcs: its ends are those of the outer dashes, and the gaps are between."""
    whole = Chain(np.array([0j, 30 + 0j, 60 + 10j]), np.array([0.0, sweep, 0.0]), "HIDDEN")
    found = list(dashed_stretch(whole, 1.0, (4.2, 1.05)))
    assert found[0].vertices[0] == 0j
    assert found[-1].vertices[-1] == pytest.approx(60 + 10j)
    share = sum(map(length, found)) / length(whole)
    assert share == pytest.approx(4.2 / 5.25, abs=0.02)
    short = Chain(np.array([0j, 3 + 0j]), np.zeros(2), "HIDDEN")
    assert list(dashed_stretch(short, 1.0, (4.2, 1.05))) == [short]


PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"

TOLERANCE = 0.01


@cache
def pair_with(upper: str = "main") -> Product:
    scene = camgeo.load(PAIR).scene.with_values({"part.pair.upper": upper, "output.fit": "fast"})
    found = camgeo.Design(scene).disc.pair
    assert found is not None
    return found


def edge_of(shape: Shape, name: str) -> Edge:
    return next(each for each in shape.edges if each.boundary.name == name)


def middles_of(chain: Chain) -> list[complex]:
    """Of its lines and arcs."""
    start, end = chain.vertices[:-1], chain.vertices[1:]
    found: list[complex] = (
        0.5 * (start + end) - 0.5j * (end - start) * np.tan(0.25 * chain.sweeps[:-1])
    ).tolist()
    return found


@pytest.mark.parametrize(("upper", "above", "below"), [
    ("main", "outline", "return outline"), ("return", "return outline", "outline"),
])  # fmt: skip
def test_the_lower_outline_is_dashed_where_the_upper_disc_lies_over_it(
    upper: str, above: str, below: str
) -> None:
    shape = Shape.from_part(pair_with(upper).drawn.part, TOLERANCE, "fast")
    over, under = (edge_of(shape, name) for name in (above, below))
    assert [each.layer for each in shape.edge_chains(over)] == ["OUTLINE"]
    chains = shape.edge_chains(under)
    layers = [each.layer for each in chains]
    assert set(layers) == {"OUTLINE", "HIDDEN"}
    assert all(one != other for one, other in zip(layers, [*layers[1:], layers[0]], strict=True))
    ends = over.contour.points(1e-5)
    disc = shapely.Polygon(np.column_stack((ends.real, ends.imag)))
    for chain, after in zip(chains, [*chains[1:], chains[0]], strict=True):
        assert abs(chain.vertices[-1] - after.vertices[0]) < 1e-6
        near = 1e-4 * shape.size
        for point in middles_of(chain):
            inside = disc.contains(shapely.Point(point.real, point.imag))
            away = disc.exterior.distance(shapely.Point(point.real, point.imag))
            assert inside == (chain.layer == "HIDDEN") or away <= 10.0 * near
    whole = float(np.sum(under.contour.lengths))
    lengths = [
        # np.sinc(x) is sin(pi x) / (pi x): an arc is longer than its chord by that
        np.abs(np.diff(each.vertices)) / np.sinc(0.5 * each.sweeps[:-1] / np.pi)
        for each in chains
    ]
    assert float(np.sum(np.concatenate(lengths))) == pytest.approx(whole, rel=1e-9)


def test_hub_and_spacer_are_hidden_as_a_whole() -> None:
    shape = Shape.from_part(pair_with().drawn.part, TOLERANCE, "fast")
    for name in ("spacer", "lower hub"):
        (chain,) = shape.edge_chains(edge_of(shape, name))
        assert chain.closed
        assert chain.layer == "HIDDEN"
