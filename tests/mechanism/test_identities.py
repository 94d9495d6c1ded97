"""The motion run backwards on a cam that turns the other way leaves the same outline."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.outline import Outline, real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import MotionPlan
from camgeo.units import TURN
from tests.mechanism.test_followers import backwards
from tests.outline.clearing import corners
from tests.strategies import BENT, attack, linked_pitch_curves, pitch_curves, signs

REVERSED = 1e-12
"""1 - lambda and the cam angles counted from the other end are rounded too, by some ulp of a turn,
times the steepness of a derivative."""

mechanisms = st.one_of(pitch_curves(BENT), linked_pitch_curves(BENT))


def reversed_(curve: PitchCurve) -> PitchCurve:
    """The motion run backwards on a cam that turns the other way."""
    motion: Motion = curve.motion
    if isinstance(motion, LinkedMotion):
        assert isinstance(motion.demanded, MotionPlan)
        motion = LinkedMotion(backwards(motion.demanded), motion.linkage)
    else:
        assert isinstance(motion, MotionPlan)
        motion = backwards(motion)
    return PitchCurve(motion, curve.follower, -curve.rotation)


def outline_of(curve: PitchCurve, side: int, radius: float) -> Outline | None:
    """None where nothing is left, or Z' = 0."""
    try:
        return real_outline(WorkingCurve(curve, side * radius))
    except GeometryError as error:
        if isinstance(error, UndercutError) or "stands still" in error.message:
            return None
        raise


@attack
@given(curve=mechanisms, side=signs(), share=st.floats(0.05, 0.8))
def test_the_motion_run_backwards_leaves_the_same_outline(
    curve: PitchCurve, side: int, share: float
) -> None:
    """With rollers up to undercut: the same corners, the same area run the other way round."""
    radius = share * curve.follower.base_radius
    one, two = outline_of(curve, side, radius), outline_of(reversed_(curve), side, radius)
    assert (one is None) == (two is None)
    if one is None or two is None:
        return
    assert len(one.path.elements) == len(two.path.elements)
    assert len(one.lobes) == len(two.lobes)
    size = REVERSED * (float(np.max(np.abs(curve.point(np.linspace(0.0, TURN, 181))))) + radius)
    ends = np.array([each.centre for each in corners(two.path)])
    for corner in corners(one.path):
        # The more the branches differ, the better the crossing is known.
        known = 64.0 * size / abs(math.sin(corner.sweep))
        assert np.min(np.abs(ends - corner.centre)) <= known
    assert area(two.path) == pytest.approx(-area(one.path), rel=1e-9)
