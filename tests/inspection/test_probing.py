"""Points to be measured: at cam angles, evenly along the flank, and whether a ball fits."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.app.answers.probe import evenly_spaced_points, flank_length, points_at_cam_angles
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank
from tests.findings import known
from tests.inspection.flanks import KINDS, TRIMMED, disc_of, flank_of

DEGREES = np.radians(np.arange(360.0))


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_points_at_cam_angles_are_those_of_the_curve(name: str, side: Flank) -> None:
    found = points_at_cam_angles(flank_of(name, side), DEGREES)
    curve = disc_of(name).cam.disc.curve(side)
    assert np.array_equal(found.places.phi, DEGREES)
    assert np.max(np.abs(found.places.points - curve.point(DEGREES))) < 1e-12
    assert found.missing == 0


def test_what_the_disc_lacks_is_left_out() -> None:
    flank = flank_of("swallow_tail", Flank.INNER)
    found = points_at_cam_angles(flank, DEGREES)
    lost = DEGREES[np.isnan(flank.positions(DEGREES))]
    assert 0 < len(lost) == found.missing == 360 - len(found.places)
    with pytest.raises(GeometryError, match="cut away"):
        points_at_cam_angles(flank, lost)


@pytest.mark.parametrize(("name", "side"), [*KINDS, *TRIMMED])
def test_even_points_are_equally_far_apart_along_the_flank(name: str, side: Flank) -> None:
    """Between two points the chord is short of the arc by its sagitta's share; a dense polygon
    measures the arcs independently.
    """
    flank = flank_of(name, side)
    found = evenly_spaced_points(flank, 3.0)
    count, length = len(found.places), flank_length(flank)
    assert length / count <= 3.0 < length / (count - 1)
    course = np.linspace(0.0, flank.total, 20_001)
    dense = np.unique(np.concatenate((course, flank.starts, found.places.course)))
    points = flank.places(dense[:-1]).points
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(np.append(points, points[0]))))))
    assert along[-1] == pytest.approx(length, rel=1e-6)
    places = np.interp(found.places.course, dense, along)
    gaps = np.diff(np.append(places, places[0] + along[-1]))
    assert np.max(np.abs(gaps - length / count)) < 1e-6 * length


def test_the_ball_must_fit() -> None:
    """On a convex flank every ball fits; in a concave part none above its radius of curvature."""
    assert points_at_cam_angles(flank_of("tappet", Flank.INNER), DEGREES, 50.0).obstructed is None
    flank = flank_of("setzhub", Flank.INNER)
    tightest = float(np.min(disc_of("setzhub").cam.disc.curve(Flank.INNER).curvature(DEGREES)))
    assert tightest < 0.0
    radius = -1.0 / tightest
    assert points_at_cam_angles(flank, DEGREES, 0.9 * radius).obstructed is None
    blocked = known(points_at_cam_angles(flank, DEGREES, 1.3 * radius).obstructed)
    assert blocked.value > 0.0
    hole = flank_of("ring", Flank.OUTER)
    assert points_at_cam_angles(hole, DEGREES, 5.0).obstructed is None
    assert points_at_cam_angles(hole, DEGREES, 0.95 * hole.size).obstructed is not None


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_centres_lie_a_radius_off_the_flank(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    found = points_at_cam_angles(flank, DEGREES[::10], 1.5)
    assert np.max(np.abs(flank.feet(found.centres).distances - 1.5)) < 1e-12
    share = 2.0 * np.sin(0.5 * found.largest_radial_angle.value) ** 2
    assert found.feigned == pytest.approx(1.5 * share)


def test_too_many_points_are_refused() -> None:
    with pytest.raises(GeometryError, match="more than 200,000"):
        evenly_spaced_points(flank_of("tappet", Flank.INNER), 1e-4)
