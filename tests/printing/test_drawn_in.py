"""Boundaries drawn into the material: exact where that has a formula, else against shapely."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.parallel import parallel
from camgeo.part.assembly import bore_outline, flattened, mark_outline
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.compensation import ScaledBoundary, drawn_in
from camgeo.part.lettering import LetterBoundary
from camgeo.part.part import Boundary
from camgeo.part.spec import DShaft, Keyway, Mark
from tests.contour.cams import SCENES
from tests.long_form import examples
from tests.strategies import attack

TOLERANCE = 1e-3
"""Of the contours that are compared [mm]."""

FLANKS = ("plate_translating", "tappet", "flat_rocker", "knife_edge", "trimmed_ring", "cut_lobe")
"""Rollers, faces and edges, a hole, outlines with corners, and one that a lobe was cut off."""


@cache
def _flank(scene: str) -> Boundary:
    """The outline of a fixture scene."""
    part = camgeo.load(SCENES / f"{scene}.toml").disc.drawn.part
    return next(each for each in part.boundaries if isinstance(each, CurveBoundary))


def _polygon(boundary: Boundary, tolerance: float = TOLERANCE) -> shapely.Polygon:
    points = boundary.polyline(tolerance, "fast").contour.vertices
    return shapely.Polygon(np.column_stack((points.real, points.imag)))


@pytest.mark.parametrize("scene", FLANKS)
@pytest.mark.parametrize("distance", [0.2, 1.5])
def test_a_flank_drawn_in_lies_that_far_in_the_material(scene: str, distance: float) -> None:
    """Each point of it is at that distance from the flank, and nothing is missing: it encloses the
    area that shapely finds.
    """
    flank = _flank(scene)
    found = drawn_in(flank, distance, "moved")
    assert (found.name, found.hole) == ("moved", flank.hole)
    before, after = _polygon(flank), _polygon(found)
    away = shapely.distance(before.exterior, shapely.points(after.exterior.coords))
    assert away == pytest.approx(distance, abs=2.0 * TOLERANCE)
    wanted = before.buffer(distance if flank.hole else -distance, quad_segs=1000)
    slack = 2.0 * TOLERANCE * before.exterior.length
    assert after.area == pytest.approx(wanted.area, abs=slack)


def test_a_flank_of_which_nothing_is_left() -> None:
    for scene in ("plate_translating", "tappet"):
        with pytest.raises(GeometryError, match="nothing is left of the outline"):
            drawn_in(_flank(scene), 200.0, "moved")


def test_only_outlines_and_lines_and_arcs_are_drawn_in() -> None:
    corners = np.array([0.0, 8.0, 8.0j])
    middles = 0.5 * (corners + np.roll(corners, -1))
    pieces = np.column_stack((corners, middles, np.roll(corners, -1)))
    letter = LetterBoundary("letter", True, pieces, 0.01)
    with pytest.raises(GeometryError, match="the letter cannot be drawn in"):
        drawn_in(letter, 0.1, "moved")


def test_what_is_scaled_is_drawn_in_by_as_much() -> None:
    found = drawn_in(ScaledBoundary(_flank("tappet"), 2.0), 0.3, "moved")
    assert isinstance(found, ScaledBoundary)
    assert (found.name, found.factor) == ("moved", 2.0)
    own = drawn_in(_flank("tappet"), 0.15, "own")
    assert found.farthest()[0] == 2.0 * own.farthest()[0]
    assert found.nearest() == 2.0 * own.nearest()


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
    fine = 1e-2 * TOLERANCE
    hole = ExactBoundary(name, True, HOLES[name])
    moved = drawn_in(ExactBoundary(name, by > 0.0, HOLES[name]), abs(by), name)
    wanted = _polygon(hole, fine).buffer(by, join_style="mitre", mitre_limit=20.0)
    found = _polygon(moved, fine)
    # At a corner, the direction of a chord of an arc, of 1 mm at least, is off by this angle; and
    # the sharpest corner magnifies what that moves less than 5 times.
    off = fine + abs(by) * math.sqrt(8.0 * fine)
    assert shapely.hausdorff_distance(found.exterior, wanted.exterior) <= 5.0 * off
    slack = fine * wanted.exterior.length + len(moved.beside(fine).contour) * abs(by) * off
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
    with pytest.raises(GeometryError, match=f"nothing is left of the {name}"):
        drawn_in(ExactBoundary(name, False, HOLES[name]), -by, name)
