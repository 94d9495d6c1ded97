from __future__ import annotations

import math

import pytest

from camgeo.check.flank import check_transmission_angle
from tests.reference import hard_case, pitch_curve_of


def test_hc15_the_follower_locks_itself_in_the_rest() -> None:
    params, expected = hard_case("HC15")
    found = check_transmission_angle(pitch_curve_of(params), math.radians(60.0))
    assert found.value == expected["mu_at_0"] == 0
    assert found.severity == "broken"


def test_hc27_a_rocker_through_the_line_of_centres_is_found_at_its_zero() -> None:
    params, expected = hard_case("HC27")
    found = check_transmission_angle(pitch_curve_of(params), math.radians(45.0))
    # u = l_1 sin(psi_t) is 0 at a bracketed root: as near as the rounding of pi lets it.
    assert found.value == pytest.approx(expected["mu"], abs=1e-12)
    assert found.severity == "broken"
    assert found.cam_angle is not None
    # The way down and the way back pass it in the middle, on either stroke.
    places = [expected["phi_deg"], 225.0]
    assert min(abs(math.degrees(found.cam_angle) - place) for place in places) < 1e-9
