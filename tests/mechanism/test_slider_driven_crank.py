from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.plan import MotionPlan
from camgeo.units import TURN
from tests.integrals import cells
from tests.long_form import examples
from tests.mechanism.bounds import assert_bounds_are_close, assert_bounds_hold
from tests.mechanism.loops import slider_driven_crank_jet
from tests.strategies import SMOOTH, attack, plans, slider_cranks, slider_driven_cranks

MOTION = 0.6  # of the linkages drawn

ROUNDING = 1e-11
"""As a share of the largest value. With 2 mm to spare cos v is 0.16 at least, by which up to five
times is divided; lengths are 450 mm at most."""

few = settings(attack, max_examples=examples(10, long=25))

jets = st.tuples(st.floats(0.0, MOTION), *[st.floats(-2.0, 2.0)] * 3).map(np.array)


@few
@given(linkage=slider_driven_cranks(), jet=jets)
def test_newton_on_the_loop_finds_the_same_slider(
    linkage: SliderDrivenCrank, jet: np.ndarray
) -> None:
    """The loop and its derivatives to the third, solved as a power series with 50 digits."""
    pin, _ = linkage.joints(jet[:1])
    near = float(pin[0].real) * (-1.0 if linkage.inner.mirrored else 1.0)
    expected = -linkage.inner.stroke_direction * slider_driven_crank_jet(linkage, jet, near)
    found = linkage.transform(jet[:, np.newaxis])[:, 0]
    # X = s_0 + eps_s s
    found[0] += linkage.inner.stroke_direction * linkage.inner.start_position
    assert found == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * np.max(np.abs(expected)))


@attack
@given(inner=slider_cranks(), stroke=st.floats(0.0, 8.0), slope=st.floats(0.2, 2.0))
def test_it_undoes_the_slider_crank(inner: SliderCrank, stroke: float, slope: float) -> None:
    """From the stroke to the crank's angle and back, with all derivatives."""
    assume(abs(math.cos(inner.coupler_angle)) > 0.2)
    linkage = SliderDrivenCrank(inner)
    path = np.zeros((4, 65))
    path[0] = np.linspace(0.0, stroke, 65)
    swing = inner.transform(path)
    # On the way to the stroke the coupler keeps clear of standing across the guide.
    assume(np.max(linkage.missing_length(swing[0])) < -0.02 * inner.coupler)
    jet = np.array([[stroke], [slope], [0.3], [-0.7]])
    back = linkage.transform(inner.transform(jet))
    size = np.max(np.abs(inner.transform(jet))) * inner.crank
    assert back[0] == pytest.approx(jet[0], abs=1e-13 * (inner.crank + inner.coupler) / 0.1)
    assert back == pytest.approx(jet, abs=1e-11 * max(size, 1.0))


@attack
@given(linkage=slider_driven_cranks())
def test_loop_and_side_hold(linkage: SliderDrivenCrank) -> None:
    angle = np.linspace(0.0, MOTION, 50)
    pin, tip = linkage.joints(angle)
    assert np.abs(pin - tip) == pytest.approx(np.full(50, linkage.coupler), rel=1e-13)
    along = (pin - tip).real
    assert np.all(np.sign(along) == np.sign(along[0]))
    jet = np.zeros((4, 50))
    jet[0] = angle
    assert np.array_equal(linkage.transform(jet)[0], linkage.stroke(angle))
    assert linkage.stroke(np.zeros(1))[0] == 0.0
    # The pin moves along the guide by the stroke, the way the drawing has it.
    moved = linkage.inner.slider_sense * linkage.stroke(angle)
    assert pin.real - pin.real[0] == pytest.approx(moved, abs=1e-12 * linkage.coupler)
    # psi is the crank's turn in the drawing, counter-clockwise.
    assert np.angle(tip / tip[0]) == pytest.approx(angle, abs=1e-13)


def test_a_crank_may_turn_over_and_over() -> None:
    linkage = SliderDrivenCrank(SliderCrank(30.0, 100.0, math.radians(40.0), True, 1, -1, 1))
    turns = np.linspace(-TURN, TURN, 2001)
    assert np.max(linkage.missing_length(turns)) < 0.0
    jet = np.zeros((4, 2001))
    jet[0] = turns
    stroke = linkage.transform(jet)[0]
    assert stroke[1000:] == pytest.approx(stroke[:1001], abs=1e-12)
    # Between its two dead points, coupler and crank on one line: Wirsig's geometry, by hand.
    height = linkage.inner.guide_height
    reach = math.sqrt(130.0**2 - height**2) - math.sqrt(70.0**2 - height**2)
    assert np.ptp(stroke) == pytest.approx(reach, rel=1e-4)


@few
@given(linkage=slider_driven_cranks(), jet=jets)
def test_mirrored_takes_the_other_angle(linkage: SliderDrivenCrank, jet: np.ndarray) -> None:
    other = SliderDrivenCrank(replace(linkage.inner, mirrored=not linkage.inner.mirrored))
    column = jet[:, np.newaxis]
    assert np.array_equal(linkage.transform(column), other.transform(-column))


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@few
@given(linkage=slider_driven_cranks(), jet=jets)
def test_the_stroke_goes_with_the_unit(
    scale: float, linkage: SliderDrivenCrank, jet: np.ndarray
) -> None:
    inner = linkage.inner
    other = SliderDrivenCrank(
        replace(inner, crank=scale * inner.crank, coupler=scale * inner.coupler)
    )
    one = scale * linkage.transform(jet[:, np.newaxis])
    size = max(np.max(np.abs(one)), scale * linkage.coupler)
    assert other.transform(jet[:, np.newaxis]) == pytest.approx(one, abs=ROUNDING * size)


@few
@given(linkage=slider_driven_cranks(), plan=plans(SMOOTH, MOTION), count=st.integers(1, 5))
def test_bounds_hold_all_over_their_cells(
    linkage: SliderDrivenCrank, plan: MotionPlan, count: int
) -> None:
    motion = LinkedMotion(plan, linkage)
    assert_bounds_hold(motion, count, ROUNDING, 1.0)
    assert np.all(np.isfinite(motion.jet_and_bounds(*cells(plan.borders, 64))[1]))


def test_bounds_are_close_next_to_a_dead_centre() -> None:
    linkage = SliderDrivenCrank(SliderCrank(60.0, 50.0, math.radians(-25.0), True, 1, -1, 1))
    low, high = linkage.dead_positions(-2.0, 2.0)
    assert_bounds_are_close(linkage, high, -1, 2.0)
    assert_bounds_are_close(linkage, low, 1, 2.0)


def test_at_its_dead_centre_it_may_rest_and_not_move() -> None:
    linkage = SliderDrivenCrank(SliderCrank(50.0, 30.0, math.radians(10.0), True, 1, -1, 1))
    dead = linkage.dead_positions(-math.pi, math.pi)
    assert linkage.missing_length(np.array(dead)) == pytest.approx(np.zeros(len(dead)), abs=1e-13)
    # Put exactly on it, as rounding allows.
    at = next(each for each in dead if linkage._along(linkage._drop(np.array([each])))[0] < 1e-5)
    jet = np.array([[at], [0.0], [0.0], [0.0]])
    assert not np.any(linkage.transform(jet)[1:])
    beyond = np.array([[at], [1.0], [0.0], [0.0]])
    beyond[0] += 1e-3 * np.sign(linkage.missing_length(np.array([at + 1e-3]))[0])
    with pytest.raises(GeometryError, match="dead centre"):
        linkage.transform(beyond)


def test_a_coupler_across_the_guide_at_stroke_0_is_refused() -> None:
    """The tip at the other branch lies under the pin: crank upright, coupler its height less."""
    inner = SliderCrank(100.0, 100.0, 0.0, True, 1, -1, -1)
    # d^2 = 2 l^2: the second tip is at (-l, 0), straight below the pin at (-l, l).
    assert abs(math.cos(inner.coupler_angle)) < 1e-14
    with pytest.raises(GeometryError, match="square to the guide") as caught:
        SliderDrivenCrank(inner)
    assert caught.value.key == "linkage"
