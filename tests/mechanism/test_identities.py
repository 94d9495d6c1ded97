"""Turned, mirrored and reversed mechanisms make turned, mirrored and the same cams: all quantities.

Of translating rollers with any guide, of rockers on either side, and of rockers behind a
slider-crank. Whole outlines that are turned or mirrored are compared in tests/outline.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

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
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.integrals import cells
from tests.mechanism.test_followers import backwards
from tests.outline.clearing import corners
from tests.strategies import BENT, attack, linked_pitch_curves, pitch_curves, signs

ROUNDING = 1e-13
"""As in the tests of the followers: some hundred ulp, of the largest value of the turn."""

REVERSED = 10.0 * ROUNDING
"""1 - lambda and the cam angles counted from the other end are rounded too, by some ulp of a turn,
times the steepness of a derivative."""

mechanisms = st.one_of(pitch_curves(BENT), linked_pitch_curves(BENT))


def angles_of(curve: PitchCurve) -> FloatArray:
    """(n,) [rad] inside of all smooth pieces, away from their ends, where derivatives may jump."""
    low, high = cells(curve.borders, 7)
    return 0.4 * low + 0.6 * high


@dataclass(frozen=True)
class Bounds:
    """What Z, Z' and Z'' are rounded by, times `share`, and what follows from that for the rest."""

    curve: PitchCurve
    phi: FloatArray
    share: float

    def of_jet(self) -> FloatArray:
        """(3, 1)"""
        jet = self.curve.jet(np.append(self.phi, np.linspace(0.0, TURN, 181)))[:3]
        return np.asarray(self.share * np.max(np.abs(jet), axis=1, keepdims=True))

    def all(self) -> dict[str, FloatArray]:
        z0, z1, z2 = self.of_jet()
        speed, bend = np.abs(self.curve.jet(self.phi)[1:3])
        turn = z1 / speed  # of the tangent
        # kappa = Im(conj(Z') Z'') / |Z'|^3
        kappa = 4.0 * z1 * bend / speed**3 + z2 / speed**2
        reach = abs(self.curve.follower.reach)
        return {
            "pitch": np.full(len(speed), z0),
            "inner": z0 + self.curve.follower.roller_radius * turn,
            "outer": z0 + self.curve.follower.roller_radius * turn,
            "kappa": kappa,
            "mu": 4.0 * turn,
            "leverage": 4.0 * reach * turn,
        }


def quantities(curve: PitchCurve, phi: FloatArray) -> dict[str, FloatArray | ComplexArray]:
    roller = curve.follower.roller_radius
    return {
        "pitch": curve.point(phi),
        "inner": WorkingCurve(curve, -roller).point(phi),
        "outer": WorkingCurve(curve, roller).point(phi),
        "kappa": curve.curvature(phi),
        "mu": curve.transmission_angle(phi),
        "leverage": curve.leverage(phi),
    }


def assert_images(
    curve: PitchCurve,
    image: PitchCurve,
    seen: Callable[[ComplexArray], ComplexArray],
    *,
    share: float = ROUNDING,
    sense: float = 1.0,
    lever: float = 1.0,
) -> None:
    """`image` at `sense` phi is what `seen` makes of `curve` at phi, with the same scalars."""
    phi = angles_of(curve)
    bounds = Bounds(curve, phi, share).all()
    here, there = quantities(curve, phi), quantities(image, sense * phi)
    for name, values in here.items():
        expected = seen(values.astype(np.complex128)) if np.iscomplexobj(values) else values
        if name == "leverage":
            expected = lever * values
        assert np.all(np.abs(there[name] - expected) <= bounds[name]), name


def mirrored(curve: PitchCurve) -> PitchCurve:
    """The mechanism, with the linkage in front of it, in a mirror on the x axis."""
    follower, motion = curve.follower, curve.motion
    if isinstance(follower, TranslatingRoller):
        image: TranslatingRoller | OscillatingRoller = replace(
            follower, offset=-follower.offset, guide_angle=-follower.guide_angle
        )
    else:
        assert isinstance(follower, OscillatingRoller)
        image = replace(follower, pivot=follower.pivot.conjugate(), arm_side=-follower.arm_side)
    if isinstance(motion, LinkedMotion):
        assert isinstance(motion.linkage, SliderCrank)
        linkage = replace(motion.linkage, mirrored=not motion.linkage.mirrored)
        motion = LinkedMotion(motion.demanded, linkage)
    return PitchCurve(motion, image, -curve.rotation)


@attack
@given(curve=mechanisms, angle=st.floats(-math.pi, math.pi))
def test_turning_guide_or_pivot_turns_the_cam(curve: PitchCurve, angle: float) -> None:
    turn = cmath.exp(1j * angle)
    follower = curve.follower
    if isinstance(follower, TranslatingRoller):
        turned: TranslatingRoller | OscillatingRoller = replace(
            follower, guide_angle=follower.guide_angle + angle
        )
    else:
        assert isinstance(follower, OscillatingRoller)
        turned = replace(follower, pivot=follower.pivot * turn)
    assert_images(curve, replace(curve, follower=turned), lambda z: np.asarray(z * turn))


@attack
@given(curve=mechanisms)
def test_the_mirror_image_makes_the_mirror_image(curve: PitchCurve) -> None:
    """Leverage is along the outward normal; behind a linkage the lift, an angle, is mirrored."""
    lever = -1.0 if isinstance(curve.motion, LinkedMotion) else 1.0
    assert_images(curve, mirrored(curve), np.conj, lever=lever)


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


@attack
@given(curve=mechanisms)
def test_the_motion_run_backwards_makes_the_same_cam(curve: PitchCurve) -> None:
    """psi~(phi) = psi(-phi) with -sigma."""
    assert_images(curve, reversed_(curve), lambda z: z, share=REVERSED, sense=-1.0)


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
    (size, _, _) = Bounds(curve, np.zeros(1), REVERSED).of_jet()[:, 0]
    size += REVERSED * radius
    ends = np.array([each.centre for each in corners(two.path)])
    for corner in corners(one.path):
        # The more the branches differ, the better the crossing is known.
        known = 64.0 * size / abs(math.sin(corner.sweep))
        assert np.min(np.abs(ends - corner.centre)) <= known
    assert area(two.path) == pytest.approx(-area(one.path), rel=1e-9)
