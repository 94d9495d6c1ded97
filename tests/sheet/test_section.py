"""The section of parts of circles, whose cut faces, edges and chamfers are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import Contour
from camgeo.part.assembly import bevelled as part_with
from camgeo.part.assembly import bore_boundary
from camgeo.part.part import Boundary, Layer, Part
from camgeo.part.spec import Chamfer, Chamfers, Keyway, PartSpec
from camgeo.pictures.sheet.marks import Chain, Hatched, Mark
from camgeo.pictures.sheet.section import hatching, section
from camgeo.pictures.sheet.shape import COARSE, Shape, bevelled, corners_of, edges_above, shape_of
from tests.part.parts import FLANKS, circle, made_or_refused, specs


def cut(*layers: Layer) -> list[Mark]:
    return section(shape_of(Part(layers), 0.01, "fast"))


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


def test_hatching_stays_in_its_face_at_its_distance() -> None:
    face = Hatched(np.array([1 + 2j, 9 + 2j, 9 + 30j, 1 + 30j]))
    found = list(hatching(face, 2.5))
    assert found
    rises = sorted(start.imag - start.real for start, _ in found)
    assert np.allclose(np.diff(rises), 2.5 * math.sqrt(2.0))
    for ends in found:
        assert ends[1] - ends[0] == pytest.approx((ends[1] - ends[0]).real * (1 + 1j))
        for end in ends:
            assert 1.0 - 1e-9 <= end.real <= 9.0 + 1e-9
            assert 2.0 - 1e-9 <= end.imag <= 30.0 + 1e-9


@given(st.sampled_from(list(FLANKS)), specs())
@settings(max_examples=15)
def test_random_parts_are_cut_as_their_polygons_are(contact: Contact, spec: PartSpec) -> None:
    """Any layers: their material on the plane by polygons, and the edges below others."""
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    shape = shape_of(part, 0.01, "fast")
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
    shape = shape_of(PART, 0.01, "fast")
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
    for corner in corners_of(drawn()[0]):
        assert not any(abs(end - corner.sharp) < 0.2 for end in ends)


def test_hatching_stays_in_a_face_without_corners() -> None:
    face = Hatched(np.array([1 + 0j, 9 + 0j, 10 + 1j, 10 + 9j, 9 + 10j, 0 + 10j, 0 + 1j]))
    polygon = face.corners
    found = list(hatching(face, 0.7))
    length = sum(abs(end - start) for start, end in found)
    assert length * 0.7 == pytest.approx(abs(Contour.polygon(polygon).area), rel=0.02)
    sides = np.roll(polygon, -1) - polygon
    for ends in found:
        for end in ends:
            assert np.all(((end - polygon) * np.conj(sides)).imag >= -1e-9)


def test_mitres_join_the_corners_of_a_keyway() -> None:
    """Seen from above, from corner to corner; beside the circle they are bent."""
    wall = bore_boundary(20.0, Keyway(6.0, 2.8))
    part = Part((Layer(-10.0, 0.0, (OUTLINE, wall)),))
    part = part_with(part, Chamfers(bore=Chamfer(2.0, "upper")), 0.01)
    chains = list(edges_above(shape_of(part, 1e-3, "fast"), 1e-3, "fast"))
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
