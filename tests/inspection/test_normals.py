"""Normals stated in files: true, radial, reversed, or just wrong."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.outline.exact_flank import Feet
from camgeo.geometry.outline.path import Flank
from camgeo.studies.inspection import false_share, radius_angles, stated_normals
from tests.inspection.flanks import KINDS, every, flank_of


def feet_of(name: str, side: Flank) -> Feet:
    flank = flank_of(name, side)
    return flank.feet(every(flank, 120).points)


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_radial_normals_are_told_from_true_ones(name: str, side: Flank) -> None:
    feet = feet_of(name, side)
    true = feet.places.normals
    turn, turned = 0.5, np.exp(0.5j)
    found = stated_normals(feet, turn, turned * true)
    assert not found.radial
    assert not found.into_material
    assert found.largest.value < 1e-9
    radii = -side.sign * feet.places.points
    for sign in (1.0, -1.0):
        radial = stated_normals(feet, turn, sign * turned * radii)
        assert radial.radial
        assert radial.into_material == (sign < 0.0)
        assert radial.largest.value == pytest.approx(np.max(np.abs(radius_angles(feet))))


def test_wrong_normals_are_not_radial_ones() -> None:
    feet = feet_of("plate_translating", Flank.INNER)
    normals = feet.places.normals.copy()
    normals[7] *= np.exp(0.2j)
    found = stated_normals(feet, 0.0, normals)
    assert not found.radial
    assert found.largest.value == pytest.approx(0.2, abs=1e-9)
    assert found.largest.place == feet.places.phi[7]


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_the_feigned_deviation_is_that_of_a_ball(name: str, side: Flank) -> None:
    """The ball's centre less its radius along the radius lies off the flank by r (1 - cos delta),
    to the first order of the flank's curvature times what the point moves along it.
    """
    flank = flank_of(name, side)
    places = every(flank, 60)
    ball = 0.01
    centres = places.points + ball * places.normals
    radii = -side.sign * places.points / np.abs(places.points)
    seeming = flank.feet(centres - ball * radii).distances
    share = false_share(radius_angles(flank.feet(places.points)))
    assert np.max(np.abs(seeming - ball * share)) < 0.02 * ball
    assert np.max(share) > 0.01
