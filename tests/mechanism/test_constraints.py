"""Every mechanism against its own constraint equations, closed by Newton to 40 digits."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.units import TURN
from tests.long_form import examples
from tests.mechanism.constraints import (
    Beside,
    CarriageChain,
    Chain,
    FaceChain,
    FourBarChain,
    OscillatingChain,
    Rocker,
    SliderCrankChain,
    TranslatingChain,
    close,
)
from tests.mechanism.flat_faces import convex_curves
from tests.pairs import Lever, Pair, pairs
from tests.reference import (
    POLYNOMIAL,
    hard_case,
    inner_of,
    mechanisms,
    outer_of,
    pitch_curve_of,
    stroke_of,
)
from tests.strategies import (
    SMOOTH,
    four_bars,
    pitch_curves,
    signs,
    slider_cranks,
    slider_driven_cranks,
)

EPS = 2.0**-52

ROUNDINGS = 16.0
"""Of all lengths together: each enters a curve after a dozen operations of half an ulp or so, and
wrong gaps move the roller by the stiffness of the chain."""

few = settings(max_examples=examples(3, long=8))


def chain_of(curve: PitchCurve) -> Chain:
    """The lengths of a mechanism, and on which sides its joints lie."""
    follower, linkage = curve.follower, None
    if isinstance(curve.motion, LinkedMotion):
        linkage = curve.motion.linkage
    if isinstance(follower, TranslatingRoller):
        guide = TranslatingChain(
            follower.base_radius, follower.offset, follower.guide_angle, follower.direction
        )
        return guide if linkage is None else carriage_chain(guide, linkage)
    assert isinstance(follower, OscillatingRoller)
    rocker = Rocker(follower.pivot, follower.arm, follower.base_radius, follower.arm_side)
    if isinstance(linkage, FourBar):
        pin = linkage.shaft + cmath.rect(linkage.lever, linkage.lever_angle)
        return FourBarChain(
            rocker,
            linkage.crank,
            linkage.coupler,
            linkage.lever,
            linkage.shaft,
            pin,
            linkage.lever_sense,
            -linkage.branch,
        )
    if linkage is None:
        assert follower.direction is not None
        return OscillatingChain(rocker, follower.direction)
    assert isinstance(linkage, SliderCrank)
    return linked_chain(rocker, linkage)


def carriage_chain(guide: TranslatingChain, linkage: Linkage) -> CarriageChain:
    """A crank in front of `guide`: the slider-crank by its places, with another end driven."""
    assert isinstance(linkage, SliderDrivenCrank)
    inner = linkage.inner
    chain = linked_chain(Rocker(1j, 1.0, 1.0, 1), inner)  # of which only the linkage counts
    # Its tip is where the coupler is parallel to the guide, or mirrored at the line shaft to pin.
    lean = inner.crank * math.sin(inner.deflection) * (-1.0 if inner.leans_away else 1.0)
    left = 1 if inner.mirrored else -1
    tip = complex(left * inner.slider_side * lean, inner.crank * math.cos(inner.deflection))
    if (tip * chain.pin.conjugate()).imag * chain.tip_side < 0.0:
        along = chain.pin / abs(chain.pin)
        tip = along * (tip / along).conjugate()
    return CarriageChain(guide, inner.crank, inner.coupler, chain.pin, chain.sense, tip)


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


def agree(curve: PitchCurve, phi: list[float], chain: Chain | None = None) -> None:
    """Pitch curve and working curves at `phi` [rad] against the closed chain, and their touch."""
    demand: Motion = stroke_of(curve)
    chain = chain_of(curve) if chain is None else chain
    angles = np.unique(np.concatenate((np.linspace(0.0, 2.0 * math.pi, 61), phi)))
    wanted = [int(np.searchsorted(angles, each)) for each in phi]
    lifts, rates = demand.jet(angles)[:2]
    where = angles[sorted(wanted)]
    size = chain.size + float(np.max(np.abs(lifts))) * float(
        isinstance(curve.follower, TranslatingRoller)
    )
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


@few
@given(linkage=four_bars(), phi=some_angles(), rotation=signs(), side=signs())
def test_rocker_behind_a_four_bar(
    linkage: FourBar, phi: list[float], rotation: int, side: int
) -> None:
    rocker = OscillatingRoller(-70.0 - 50.0j, 80.0, 60.0, 6.0, side, None)
    agree(PitchCurve(LinkedMotion(there_and_back(0.6), linkage), rocker, rotation), phi)


@few
@given(linkage=slider_driven_cranks(), phi=some_angles(), rotation=signs(), direction=signs())
def test_carriage_behind_a_crank(
    linkage: SliderDrivenCrank, phi: list[float], rotation: int, direction: int
) -> None:
    # A crank of 150 mm moves its slider by 300 mm at most.
    guide = TranslatingRoller(400.0, 6.0, 30.0, 0.3, direction)
    agree(PitchCurve(LinkedMotion(there_and_back(0.6), linkage), guide, rotation), phi)


def there_and_back(motion: float) -> MotionPlan:
    return MotionPlan((Move(Decimal(150), motion, POLYNOMIAL), Move(Decimal(210), 0.0, POLYNOMIAL)))


@few
@given(pair=pairs(), phi=some_angles())
def test_both_rollers_of_a_pair(pair: Pair, phi: list[float]) -> None:
    """One body closes both: the return roller is a second point of the body."""
    main = chain_of(pair.main)
    body = pair.body
    if isinstance(body, Lever):
        place = cmath.rect(body.arms[1] / body.arms[0], body.between)
        other = Beside(main, body.pivot, place)
    else:
        other = Beside(main, None, body.apart)
    agree(pair.main, phi, main)
    agree(pair.other, phi, other)


@few
@given(curve=convex_curves(), phi=some_angles())
def test_a_flat_face_touches_where_it_slides(curve: PitchCurve, phi: list[float]) -> None:
    """The face's line by two points of the closed chain. It touches where their relative motion in
    the cam has no part across it: there is the outline's point, along it its tangent, and nothing
    of the outline lies beyond.
    """
    follower = curve.follower
    first, second, out = face_chains(follower)
    angles = np.unique(np.concatenate((np.linspace(0.0, TURN, 61), phi)))
    wanted = [int(np.searchsorted(angles, each)) for each in phi]
    demand = curve.motion
    lifts, rates = demand.jet(angles)[:2]
    where, rates = angles[sorted(wanted)], rates[sorted(wanted)]
    ends = [close(chain, lifts, wanted) for chain in (first, second)]
    points, tangents = curve.jet(where)[:2]
    outline = curve.point(np.linspace(0.0, TURN, 721))
    for number, (here, there) in enumerate(zip(*ends, strict=True)):
        with mp.workdps(40):
            turn = mp.expj(curve.rotation * mpf(where[number]))
            point = mpc(points[number]) * turn
            length = abs(there.roller - here.roller)
            along = (there.roller - here.roller) / length
            normal = out * along
            rate = mpf(rates[number])
            slips = [
                mp.re(mp.conj(normal) * (each.rate * rate - 1j * curve.rotation * each.roller))
                for each in (here, there)
            ]
            tau = (slips[1] - slips[0]) / length
            contact = here.roller - along * slips[0] / tau
            size = second.size + float(abs(point)) + float(np.max(np.abs(lifts)))
            limit = ROUNDINGS * EPS * size * (1.0 + max(here.stiffness, there.stiffness))
            limit *= 1.0 + abs(float(rate))
            across = float(mp.re(mp.conj(normal) * (point - here.roller)))
            assert abs(across) <= limit
            assert abs(point - contact) <= limit * (1.0 + 1.0 / abs(float(tau)))
            tangent = mpc(tangents[number]) * turn
            assert abs(mp.re(mp.conj(normal) * tangent)) <= limit / size * abs(tangent)
            beyond = np.real(np.conj(complex(normal)) * (outline * complex(turn)))
            height = float(mp.re(mp.conj(normal) * here.roller))
            assert float(np.max(beyond)) <= height + limit


def face_chains(follower: Follower) -> tuple[Chain, Chain, complex]:
    """Two points of a face, and its normal away from the cam axis over the way from the first."""
    if isinstance(follower, TranslatingFlat):
        guide = TranslatingChain(
            follower.base_radius, 0.0, follower.guide_angle, follower.direction
        )
        right = cmath.rect(follower.base_radius, follower.guide_angle - 0.5 * math.pi)
        return guide, Beside(guide, None, right), 1j
    assert isinstance(follower, OscillatingFlat)
    side = follower.arm_side
    sense = 1 if follower.direction is None else follower.direction * side
    arm = abs(follower.pivot)
    chain = FaceChain(follower.pivot, arm, follower.face_offset, follower.base_radius, side, sense)
    # The arm, with what the face lies beyond it a quarter turn on.
    beyond = 1j * side * follower.face_offset / arm
    return (
        Beside(chain, follower.pivot, beyond),
        Beside(chain, follower.pivot, 1.0 + beyond),
        1j * side,
    )


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
    large = replace(curve.follower, base_radius=curve.follower.base_radius * (1.0 + 1e-12))  # type: ignore[type-var]  # every follower is a dataclass
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


def test_a_chain_that_cannot_close_is_reported() -> None:
    linkage = SliderCrank(42.0, 75.38, math.radians(6.3), True, 1, 1, 1)
    chain = linked_chain(Rocker(-34.81 - 84.39j, 84.9, 47.654, 1), linkage)
    with pytest.raises(AssertionError, match="does not close"):
        close(chain, np.array([0.0, 60.0]), [1])
    plan = MotionPlan((Move(Decimal(180), 60.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
    with pytest.raises(GeometryError, match="does not close"):
        LinkedMotion(plan, linkage)
