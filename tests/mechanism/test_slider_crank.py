from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slider_crank import SliderCrank


def test_a_cell_that_may_reach_a_dead_centre_has_no_bound() -> None:
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    full = linkage.crank + linkage.coupler
    reach = math.sqrt(full**2 - linkage.guide_height**2) - linkage.start_position
    jet = np.array([[reach - 1.0], [1.0], [0.0], [0.0]])
    near = linkage.transform_bounds(jet, np.array([[0.5], [1.0], [0.0], [0.0]]))
    assert np.all(np.isfinite(near))
    beyond = linkage.transform_bounds(jet, np.array([[2.0], [1.0], [0.0], [0.0]]))
    assert np.all(np.isinf(beyond))
    rest = linkage.transform_bounds(jet, np.zeros((4, 1)))
    assert not np.any(rest)


# The questions of the thesis ------------------------------------------------------------------


@pytest.mark.parametrize("leans_away", [True, False])
@pytest.mark.parametrize("slider_side", [1, -1])
def test_at_stroke_0_the_slider_lies_where_the_words_say(
    leans_away: bool, slider_side: int
) -> None:
    """Wirsig, section 3.3: s_0 = l_4 -+ l_sk sin(alpha_sk), to the left for +1."""
    linkage = SliderCrank(40.0, 70.0, math.radians(30.0), leans_away, slider_side, 1, 1)
    assert linkage.guide_height == pytest.approx(40.0 * math.sqrt(0.75), rel=1e-15)
    expected = slider_side * (50.0 if leans_away else 90.0)
    assert linkage.start_position == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("leans_away", "slider_side", "branch", "start"),
    [(True, 1, 1, 60.0), (True, -1, -1, 120.0), (False, 1, 1, 120.0)],
)
def test_the_dimensions_are_those_of_a_coupler_parallel_to_the_guide(
    leans_away: bool, slider_side: int, branch: int, start: float
) -> None:
    """The three consistent answers of mechanisms.md 4.2; the other branch is off."""
    linkage = SliderCrank(40.0, 70.0, math.radians(30.0), leans_away, slider_side, 1, branch)
    assert math.sin(linkage.coupler_angle) == pytest.approx(0.0, abs=1e-14)
    assert math.degrees(linkage.start_angle) == pytest.approx(start, rel=1e-14)
    other = replace(linkage, branch=-branch)
    assert abs(math.sin(other.coupler_angle)) > 0.01


def test_a_dead_centre_can_be_rested_in_but_not_left() -> None:
    linkage = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
    assert linkage.missing_length(np.zeros(1))[0] == pytest.approx(0.0, abs=2e-14)
    assert not np.any(linkage.transform(np.zeros((4, 1))))
    with pytest.raises(GeometryError, match="dead centre") as caught:
        linkage.transform(np.array([[0.0], [0.0], [1.0], [0.0]]))
    assert caught.value.key == "linkage"


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_swing_at_a_stroke_does_not_depend_on_the_others(mirrored: bool) -> None:
    """Not in its last bit: within half a turn, beyond it, and at rest in a dead centre."""
    across = SliderCrank(60.0, 92.0, -1.134, True, 1, 1, 1, mirrored)
    dead = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, -1, mirrored)
    moving = np.zeros((4, 4))
    moving[0], moving[1] = (-60.0, 0.0, 3.0, -200.0), (1.0, 0.0, -1.0, 2.0)
    resting = np.zeros((4, 3))
    resting[0] = 0.0, 3.0, -0.0
    assert abs(across.crank_angle(moving[0]) - across.start_angle)[3] > math.pi
    for linkage, jet in ((across, moving), (dead, resting)):
        together = linkage.transform(jet)
        for place in range(jet.shape[1]):
            alone = linkage.transform(jet[:, [place]])
            assert alone.tobytes() == together[:, [place]].tobytes()


# Joints, for masses and loads ------------------------------------------------------------------


def test_a_printed_connecting_rod_turns_as_printed() -> None:
    """A Mathcad sheet of a slider-crank with the crank at 45 degrees, 1 rad/s: theta_3 = 159.295
    degrees, omega_3 = 0.378 rad/s, piston 9.744 in/s ("Slider-crank Analysis",
    coursehero.com/file/6680931/fourbar-mathcad). The angles give b = 2 a, the piston a = 10 in."""
    linkage = SliderCrank(10.0, 20.0, math.pi / 2.0, False, -1, 1, -1)  # in line, stretched out
    stroke = 30.0 - (10.0 * math.cos(math.pi / 4.0) + math.sqrt(400.0 - 50.0))
    pin, tip = linkage.joints(np.array([stroke]))
    assert math.degrees(float(np.angle(tip[0]))) == pytest.approx(45.0, rel=1e-12)
    assert 180.0 + math.degrees(float(np.angle(pin[0] - tip[0]))) == pytest.approx(
        159.295, abs=5e-4
    )
    slide = linkage.per_follower(np.array([stroke]))
    assert abs(slide[0]) == pytest.approx(9.744, abs=5e-4)
    turn = (linkage.slider_sense * slide - 1j * tip) / (1j * (pin - tip))  # of the coupler
    assert abs(turn[0]) == pytest.approx(0.378, abs=5e-4)


# The coupler of `HANGING` stands across the guide where the tip is below the pin, 40 mm over the
# shaft: X = -sqrt(100^2 - 40^2), reached to the right from X = 60.
