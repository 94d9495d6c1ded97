from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.units import TURN


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
