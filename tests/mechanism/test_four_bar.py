from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from camgeo.check.machine import check_linkage
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.reference import POLYNOMIAL


def test_a_rocker_may_turn_more_than_half_a_turn_with_no_jump() -> None:
    """A drag link: the shaft distance is the shortest, both levers turn all round, for ever."""
    linkage = FourBar(60.0, 70.0, 65.0, 20.0 + 0.0j, 0.3, 1, 1)
    turns = np.linspace(-3.0 * TURN, 3.0 * TURN, 6001)
    jet = np.zeros((4, 6001))
    jet[0], jet[1] = turns, 1.0
    swing = linkage.transform(jet)[0]
    assert np.max(np.abs(np.diff(swing))) < 0.05
    # Each turn of the lever is one of the crank.
    assert swing[-1] - swing[0] == pytest.approx(6.0 * TURN, rel=1e-13)
    assert not linkage.dead_positions(-9.0, 9.0)


PARALLELOGRAM = FourBar(40.0, 100.0, 40.0, 100.0 + 0.0j, math.radians(60.0), 1, -1)


def test_a_parallelogram_keeps_its_branch() -> None:
    jet = np.zeros((4, 50))
    jet[0], jet[1] = np.linspace(0.0, math.radians(110.0), 50), 1.0
    swing = PARALLELOGRAM.transform(jet)
    assert swing[0] == pytest.approx(jet[0], abs=1e-13)
    assert swing[1] == pytest.approx(np.ones(50), rel=1e-12)
    assert swing[2:] == pytest.approx(np.zeros((2, 50)), abs=1e-11)
    # Crank and coupler fold and stretch at the change points, with a double root each: 1e-8 rad.
    dead = np.degrees(PARALLELOGRAM.dead_positions(-2.0, 3.0))
    assert np.min(np.abs(dead - np.array([[-60.0], [120.0]])), axis=0) == pytest.approx(
        np.zeros(len(dead)), abs=1e-5
    )
    assert np.ptp(dead) == pytest.approx(180.0, abs=1e-5)


def test_a_change_point_is_a_dead_centre() -> None:
    """Passing it, the linkage could fold into the antiparallelogram: refused where it is moving."""
    third = Decimal(120)
    to = math.radians(130.0)
    plan = MotionPlan((Dwell(third), Move(third, to, POLYNOMIAL), Move(third, 0.0, POLYNOMIAL)))
    (found,) = check_linkage(LinkedMotion(plan, PARALLELOGRAM))
    assert (found.name, found.severity) == ("dead-centre", "no-disc")
    assert "at lever angle 120 deg" in found.sentence
    assert "with the lever angle kept between -59.9999 and 120 degrees" in found.sentence
    flat = replace(PARALLELOGRAM, lever_angle=0.0)
    with pytest.raises(GeometryError, match="dead centre"):
        flat.transform(np.array([[0.0], [1.0], [0.0], [0.0]]))
    assert not np.any(flat.transform(np.zeros((4, 3))))


def test_a_dead_centre_at_the_start_keeps_the_digits() -> None:
    """Crank and coupler stretched at motion 0: psi goes with the root of the motion, as HC05."""
    linkage = FourBar(40.0, 60.0, 50.0, 100.0 + 50.0j, -0.5 * math.pi, 1, 1)
    assert linkage.missing_length(np.zeros(1))[0] == pytest.approx(0.0, abs=1e-13)
    small = np.array([1e-12, 1e-10, 1e-8])
    jet = np.zeros((4, 3))
    jet[0], jet[1] = -small, -1.0
    if linkage.missing_length(np.array([-1e-3]))[0] > 0.0:
        jet = -jet
    found = linkage.transform(jet)
    # From the exact sum of the angles at shaft and tip: d = 100 - 50 x, cosine rule to first order.
    lost = 50.0 * small
    theta = np.sqrt(2.0 * lost * 60.0 / (40.0 * 100.0))
    assert np.abs(found[0]) == pytest.approx(theta, rel=1e-4)
    assert np.abs(found[1] * 2.0 * small) == pytest.approx(theta, rel=1e-4)


def test_dimensions_that_do_not_close_are_reported_with_a_coupler_that_does() -> None:
    with pytest.raises(GeometryError, match="coupler must be") as caught:
        FourBar(40.0, 20.0, 50.0, 150.0 + 0.0j, math.radians(90.0), 1, 1)
    assert caught.value.key == "linkage"
    least = math.hypot(150.0, 50.0) - 40.0
    assert f"{least:.6g} to" in caught.value.message
    FourBar(40.0, least + 1e-9, 50.0, 150.0 + 0.0j, math.radians(90.0), 1, 1)
