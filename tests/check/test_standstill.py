from __future__ import annotations

import pytest
from hypothesis import given

from camgeo.check.flank import check_standstill
from camgeo.geometry.pitch_curve import PitchCurve
from tests.reference import hard_case, pitch_curve_of
from tests.strategies import BENT, attack, pitch_curves


@pytest.mark.parametrize("psi_g", [5.9, 6.1])
def test_close_to_it_the_linkage_moves(psi_g: float) -> None:
    """psi_t reaches -0.1 or 0.1 degrees where it stood still: 100 mm of it are 0.17 mm a rad."""
    params, _ = hard_case("HC18")
    assert check_standstill(pitch_curve_of(params | {"psi_G_deg": psi_g})) == ()


@attack
@given(curve=pitch_curves(BENT))
def test_with_a_normal_everywhere_nothing_is_reported(curve: PitchCurve) -> None:
    """Followers that stay off the line of centres, or above the cam axis, never stand still."""
    assert check_standstill(curve) == ()
