"""Many drives, or discs, evaluated at once: each has the values that it has alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from camgeo.cam.cam import Cam, Disc, Drive, discs_together, drives_together
from camgeo.geometry.pitch_curve import BLOCK
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, IntArray, Quantity, Side

LAW = make_law("modified-sine")

PLAN = MotionPlan((Move(Decimal(150), 20.0, LAW), Move(Decimal(210), 0.0, LAW)))

LINKAGE = SliderCrank(100.0, 160.0, math.radians(15.0), True, 1, 1, 1)

COUPLERS = (160.0, 170.0, 155.0, 181.0, 164.0)


def drives() -> list[Drive]:
    return [Drive(PLAN, replace(LINKAGE, coupler=each), speed=5.0) for each in COUPLERS]


def linked() -> list[Disc]:
    rocker = OscillatingRoller(-70.0 - 50.0j, 80.0, 60.0, 6.0, 1, None)
    return [
        Cam(drive, replace(rocker, base_radius=60.0 + number)).disc
        for number, drive in enumerate(drives())
    ]


def guided() -> list[Disc]:
    followers = [TranslatingRoller(50.0 + each, 6.0, 0.5 * each) for each in range(5)]
    return [Cam(Drive(PLAN), each).disc for each in followers]


def lift(drive: Drive) -> Quantity:
    return lambda phi, side: drive.motion.jet(phi, side)


def in_time(drive: Drive) -> Quantity:
    return lambda phi, side: np.asarray(drive.motion.jet(phi, side)[1] * 5.0)


def curvature(disc: Disc) -> Quantity:
    return disc.pitch_curve.curvature


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("length", [1, 37, 3 * BLOCK // 4])
def test_each_drive_has_its_own_values(count: int, side: Side, length: int) -> None:
    some = drives()[:count]
    together = drives_together(some)
    assert together.count == count
    phi = np.sort(np.concatenate((np.linspace(0.1, 6.2, length), PLAN.breaks)))[-length:]
    which = np.arange(len(phi)) % count
    for quantity in (lift, in_time):
        alone = [quantity(each)(phi, side) for each in drives()[:count]]
        every = together.everywhere(quantity, phi, side)
        assert np.array_equal(every, np.stack(alone, axis=-2))
        at = together.at(quantity, phi, side, which)
        assert np.array_equal(at, own(alone, which))
    assert len({each.tobytes() for each in alone}) == count


@pytest.mark.parametrize("made", [guided, linked])
@pytest.mark.parametrize("count", [1, 5])
def test_each_disc_has_its_own_values(made: Callable[[], list[Disc]], count: int) -> None:
    some = made()[:count]
    together = discs_together(some)
    assert together.count == count
    phi = np.linspace(0.1, 6.2, 53)
    which = np.arange(53) % count
    alone = [curvature(each)(phi, "right") for each in made()[:count]]
    assert np.array_equal(together.everywhere(curvature, phi, "right"), np.stack(alone))
    assert np.array_equal(together.at(curvature, phi, "right", which), own(alone, which))
    assert len({each.tobytes() for each in alone}) == count


def test_those_that_are_put_together_stay_as_they_are() -> None:
    some, others = drives(), linked()
    joined = list(drives_together(some).blocks(7))
    assert [times for _, times in joined] == [5]
    assert joined[0][0].ledger is not some[0].ledger
    assert joined[0][0].motion is not some[0].motion
    assert next(iter(discs_together(others).blocks(7)))[0].ledger is not others[0].ledger


def own(alone: list[FloatArray], which: IntArray) -> FloatArray:
    """(..., n) at each place the value of the one with the number in `which`."""
    return np.stack([alone[number][..., place] for place, number in enumerate(which)], axis=-1)
