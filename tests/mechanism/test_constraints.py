"""Every mechanism against its own constraint equations, closed by Newton to 40 digits."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Motion
from camgeo.motion.plan import MotionPlan, Move
from tests.mechanism.constraints import (
    Chain,
    OscillatingChain,
    Rocker,
    SliderCrankChain,
    TranslatingChain,
    close,
)
from tests.reference import (
    POLYNOMIAL,
    hard_case,
    inner_of,
    mechanisms,
    outer_of,
    pitch_curve_of,
    stroke_of,
)
from tests.strategies import SMOOTH, pitch_curves, signs, slider_cranks

EPS = 2.0**-52

ROUNDINGS = 16.0
"""Of all lengths together: each enters a curve after a dozen operations of half an ulp or so, and
wrong gaps move the roller by the stiffness of the chain."""

few = settings(max_examples=12)


def chain_of(curve: PitchCurve) -> Chain:
    """The lengths of a mechanism, and on which sides its joints lie."""
    follower = curve.follower
    if isinstance(follower, TranslatingRoller):
        return TranslatingChain(
            follower.base_radius, follower.offset, follower.guide_angle, follower.direction
        )
    assert isinstance(follower, OscillatingRoller)
    rocker = Rocker(follower.pivot, follower.arm, follower.base_radius, follower.arm_side)
    if not isinstance(curve.motion, LinkedMotion):
        assert follower.direction is not None
        return OscillatingChain(rocker, follower.direction)
    assert isinstance(curve.motion.linkage, SliderCrank)
    return linked_chain(rocker, curve.motion.linkage)


def linked_chain(rocker: Rocker, linkage: SliderCrank) -> SliderCrankChain:
    """Wirsig's questions 21 to 25 as places; `mirrored` changes left and right."""
    lean = linkage.crank * math.sin(linkage.deflection)
    distance = linkage.coupler + (-lean if linkage.leans_away else lean)
    left = -1 if not linkage.mirrored else 1
    pin = complex(
        left * linkage.slider_side * distance, linkage.crank * math.cos(linkage.deflection)
    )
    return SliderCrankChain(
        rocker,
        linkage.crank,
        linkage.coupler,
        pin,
        left * linkage.stroke_direction,
        left * linkage.branch,
    )


def agree(curve: PitchCurve, phi: list[float]) -> None:
    """Pitch curve and working curves at `phi` [rad] against the closed chain, and their touch."""
    demand: Motion = stroke_of(curve)
    chain = chain_of(curve)
    angles = np.unique(np.concatenate((np.linspace(0.0, 2.0 * math.pi, 61), phi)))
    wanted = [int(np.searchsorted(angles, each)) for each in phi]
    lifts, rates = demand.jet(angles)[:2]
    where = angles[sorted(wanted)]
    size = chain.size + float(np.max(np.abs(lifts))) * float(isinstance(chain, TranslatingChain))
    closed = close(chain, lifts, wanted)
    assert len(closed) == len(where)
    sigma, radius = curve.rotation, curve.follower.roller_radius
    pitch = curve.point(where)
    flanks = [(-radius, inner_of(curve)), (radius, outer_of(curve))]
    points = [flank.point(where) for _, flank in flanks]
    tangents = [flank.tangent(where) for _, flank in flanks]
    for number, each in enumerate(closed):
        limit = ROUNDINGS * EPS * size * (1.0 + each.stiffness)
        with mp.workdps(40):
            back = mp.expj(-sigma * mpf(where[number]))
            assert abs(mpc(pitch[number]) - each.roller * back) <= limit
            # The roller as the cam sees it: its way is what the flank must be parallel to.
            rate = mpf(rates[sorted(wanted)[number]])
            way = (each.rate * rate - 1j * sigma * each.roller) * back
            speed = float(abs(way))
            across = 1j * sigma * way / abs(way)
            for (distance, _), point, tangent in zip(flanks, points, tangents, strict=True):
                touch = mpc(point[number]) / back - each.roller
                assert abs(abs(touch) - radius) <= limit
                # Direction of the normal: that of the way, whose parts are known to `limit`.
                turn = limit * (1.0 + abs(float(rate))) / speed
                assert abs(touch * back - distance * across) <= limit + radius * turn
                assert abs((mpc(tangent[number]) * mp.conj(across)).real) <= turn


def some_angles() -> st.SearchStrategy[list[float]]:
    angle = st.floats(0.0, 2.0 * math.pi, exclude_max=True)
    return st.lists(angle, min_size=4, max_size=4, unique=True)


@few
@given(curve=pitch_curves(SMOOTH), phi=some_angles())
def test_guide_and_rocker(curve: PitchCurve, phi: list[float]) -> None:
    agree(curve, phi)


@few
@given(linkage=slider_cranks(8.0), phi=some_angles(), rotation=signs(), side=signs())
def test_rocker_behind_a_slider_crank(
    linkage: SliderCrank, phi: list[float], rotation: int, side: int
) -> None:
    plan = MotionPlan((Move(Decimal(150), 8.0, POLYNOMIAL), Move(Decimal(210), 0.0, POLYNOMIAL)))
    rocker = OscillatingRoller(-70.0 - 50.0j, 80.0, 60.0, 6.0, side, None)
    agree(PitchCurve(LinkedMotion(plan, linkage), rocker, rotation), phi)


@pytest.mark.parametrize("name", mechanisms())
def test_the_mechanisms_of_the_reference(name: str) -> None:
    rng = np.random.default_rng(sum(map(ord, name)))
    agree(pitch_curve_of(mechanisms()[name]["params"]), [*rng.uniform(0.0, 2.0 * math.pi, 3)])


def test_a_crank_that_passes_180_degrees() -> None:
    """HC26: where an arc tangent jumps the chain goes on."""
    params, _ = hard_case("HC26")
    crank = float(params["l_sk"])
    linkage = SliderCrank(crank, 48.0, math.asin(0.8), False, 1, -1, -1)
    assert linkage.start_position == pytest.approx(params["s_0"], rel=1e-15)
    plan = MotionPlan((Move(Decimal(180), 10.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
    rocker = OscillatingRoller(-70.0 - 50.0j, 80.0, 60.0, 6.0, 1, None)
    agree(PitchCurve(LinkedMotion(plan, linkage), rocker, 1), [0.7, 1.4, 1.6, 2.2, 5.0])


@pytest.mark.parametrize("name", ["trans_F_sp_e12", "osc_P_sm", "T6_setzhub_sm_program"])
def test_a_mechanism_a_little_wrong_is_seen(name: str) -> None:
    """The same angles with the base radius 1e-12 too large, and on the other branch."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    large = replace(curve.follower, base_radius=curve.follower.base_radius * (1.0 + 1e-12))  # type: ignore[type-var]
    chain = chain_of(curve)
    (rest,) = close(chain, np.zeros(1), [0])
    here = complex(rest.roller)
    apart = abs(replace(curve, follower=large).point(np.zeros(1))[0] - here)
    assert apart > ROUNDINGS * EPS * chain.size * (1.0 + rest.stiffness)
    if not isinstance(chain, SliderCrankChain):
        return
    other = replace(chain, tip_side=-chain.tip_side)
    lifts = np.linspace(0.0, 20.0, 5)
    ends = [close(each, lifts, [4])[0].roller for each in (chain, other)]
    assert abs(ends[0] - ends[1]) > 1.0


def test_a_chain_that_cannot_close_is_told() -> None:
    linkage = SliderCrank(42.0, 75.38, math.radians(6.3), True, 1, 1, 1)
    chain = linked_chain(Rocker(-34.81 - 84.39j, 84.9, 47.654, 1), linkage)
    with pytest.raises(AssertionError, match="does not close"):
        close(chain, np.array([0.0, 60.0]), [1])
    plan = MotionPlan((Move(Decimal(180), 60.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
    with pytest.raises(GeometryError, match="does not close"):
        LinkedMotion(plan, linkage)
