"""Chamfers on a sheet: the corners of the section, edges from above, dimensions and notes."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.part.assembly import bore_boundary
from camgeo.part.bevels import bevelled as part_with
from camgeo.part.part import Layer, Part
from camgeo.part.spec import Chamfer, Chamfers, Keyway
from camgeo.pictures.sheet.marks import Hatched, Mark
from camgeo.pictures.sheet.section import hatching, section
from camgeo.pictures.sheet.shape import Shape, bevelled, corners_of, edges_above, shape_of
from tests.sheet.test_section import BORE, HUB, OUTLINE, lines

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
