"""Places of an exact flank, and the feet of points on it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank, Path, Pivot
from tests.inspection.flanks import KINDS, TRIMMED, every, flank_of, measured

ROUNDING = 1e-12
"""Of places of discs up to 200 mm large [mm], some dozen roundings."""


@pytest.mark.parametrize(("name", "side"), KINDS + TRIMMED)
def test_the_foot_of_a_point_is_where_it_was_moved_from(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    rng = np.random.default_rng(1)
    places = flank.places(np.sort(rng.uniform(0.0, flank.total, 300)))
    away = rng.normal(0.0, 1e-3, 300)
    feet = flank.feet(measured(places, away))
    assert np.max(np.abs(feet.distances - away)) < ROUNDING
    assert np.max(np.abs(feet.places.points - places.points)) < 100.0 * ROUNDING
    assert np.all((feet.places.phi >= 0.0) & (feet.places.phi < 2.0 * np.pi))


@pytest.mark.parametrize(("name", "side"), KINDS + TRIMMED)
def test_distances_are_those_of_an_independent_method(name: str, side: Flank) -> None:
    """Shapely measures to a polygon of 50,000 exact points, off by the sagitta of its chords."""
    flank = flank_of(name, side)
    course = np.unique(np.append(np.linspace(0.0, flank.total, 50_001), flank.starts))[:-1]
    polygon = flank.places(course)
    points = polygon.points
    turns = np.abs(np.angle(np.roll(polygon.normals, -1) * polygon.normals.conj()))
    chords = np.abs(np.roll(points, -1) - points)
    sagitta = float(np.max((chords * turns / 8.0)[turns < 0.1]))
    ring = shapely.Polygon(np.column_stack((points.real, points.imag)))
    rng = np.random.default_rng(2)
    some = every(flank, 40)
    tried = some.points + rng.normal(0.0, 0.5, 40) * np.exp(2j * np.pi * rng.random(40))
    feet = flank.feet(tried)
    spots = shapely.points(tried.real, tried.imag)
    inside = shapely.contains(ring, spots)
    into = inside if side is Flank.INNER else ~inside
    expected = np.where(into, -1.0, 1.0) * shapely.distance(ring.exterior, spots)
    assert np.max(np.abs(feet.distances - expected)) < 1.1 * sagitta + 1e-12
    assert sagitta < 2e-6
    back = feet.places.points + feet.distances * feet.places.normals
    assert np.max(np.abs(back - tried)) < 1e-9


@given(
    st.sampled_from(KINDS + TRIMMED),
    st.floats(0.0, 1.0),
    st.complex_numbers(max_magnitude=8.0, allow_nan=False),
)
def test_no_place_is_nearer_than_the_foot(
    kind: tuple[str, Flank], share: float, away: complex
) -> None:
    """Whatever the point; the foot lies on the flank, and its normal leads to the point."""
    flank = flank_of(*kind)
    course = np.array([share * flank.total])
    point = flank.places(course).points + away
    feet = flank.feet(point)
    distance = float(feet.distances[0])
    assert abs(distance) <= abs(away) + ROUNDING
    assert abs(distance) <= float(np.min(np.abs(flank.nodes.points - point))) + ROUNDING
    assert abs(flank.places(feet.places.course).points - feet.places.points)[0] < 100.0 * ROUNDING
    back = feet.places.points + distance * feet.places.normals
    assert abs(back - point)[0] < 1e-8


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_normals_point_out_of_the_material_and_turn_with_the_path(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    course = np.linspace(0.1, 6.0, 50)
    step = 1e-6
    ahead, behind = flank.places(course + step).points, flank.places(course - step).points
    along = (ahead - behind) / np.abs(ahead - behind)
    places = flank.places(course)
    assert np.max(np.abs((along * places.normals.conj()).real)) < 1e-6
    outward = (places.normals * places.points.conj()).real
    assert np.all(outward > 0.0 if side is Flank.INNER else outward < 0.0)
    nodes, turned = flank.nodes, flank.turned
    assert abs(abs(np.sum(turned)) - 2.0 * np.pi) < 1e-9
    assert len(nodes) == len(turned)


def test_beyond_a_corner_the_normal_points_from_it() -> None:
    flank = flank_of("swallow_tail", Flank.INNER)
    (corner,) = flank.path.pivots
    assert corner.distance == 0.0
    middle = corner.normal * np.exp(0.5j * corner.sweep)
    feet = flank.feet(np.array([corner.centre + 0.25 * middle]))
    assert feet.places.points[0] == pytest.approx(corner.centre, abs=1e-9)
    assert feet.distances[0] == pytest.approx(0.25, abs=1e-9)
    assert feet.places.normals[0] == pytest.approx(middle, abs=1e-8)
    at_it = flank.feet(np.array([corner.centre]))
    assert abs(at_it.distances[0]) < 1e-9
    assert abs(abs(at_it.places.normals[0]) - 1.0) < 1e-12


def test_cam_angles_that_the_disc_lacks_have_no_place() -> None:
    flank = flank_of("swallow_tail", Flank.INNER)
    phi = np.radians(np.arange(360.0))
    course = flank.positions(phi)
    there = ~np.isnan(course)
    assert 300 < np.count_nonzero(there) < 360
    off = np.angle(np.exp(1j * (flank.places(course[there]).phi - phi[there])))
    assert np.max(np.abs(off)) < 1e-12


def test_a_joint_with_a_shock_has_a_place() -> None:
    """Where the velocity jumps, the stretch that begins there has the cam angle, rounded or not."""
    flank = flank_of("straight_moves", Flank.INNER)
    shocks = np.array([each.phi_end for each in flank.path.pivots if each.distance != 0.0])
    assert len(shocks) > 0
    for rounding in (-4e-16, 0.0, 4e-16):
        assert not np.any(np.isnan(flank.positions(shocks + rounding)))


def test_an_outline_without_stretches_is_refused() -> None:
    path = Path((Pivot(0j, 1.0, 1.0 + 0j, 1.0, 0.0, 0.0),))
    with pytest.raises(ValueError, match="without any stretch"):
        ExactFlank(path, Flank.INNER)
