"""A motion as pictures show it, for which no cam is needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.files.sketch import PlanSketch, plan_sketch
from camgeo.numeric.arrays import FloatArray
from camgeo.pickled import Pickled
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.cam.drive import Drive, LiftUnit

LIFT = ("s", "s1", "s2", "s3")
"""Lift and its derivatives, as quantities."""


@dataclass(frozen=True)
class PicturedMotion(Pickled):
    """What pictures show of a motion.

    Attributes
    ----------
    drive : what moves the follower.
    lift_unit : of the follower's own motion.
    """

    drive: Drive
    lift_unit: LiftUnit

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad]: "s", "s1", "s2", "s3", the lift and its derivatives [mm
        or rad per rad^k].
        """
        lift: FloatArray = self.drive.motion.jet(np.atleast_1d(phi))[LIFT.index(what)]
        return lift

    @property
    def plan_sketch(self) -> PlanSketch:
        """The motion plan."""
        drive = self.drive
        return plan_sketch(
            drive.plan,
            of=drive.demanded_of,
            unit=drive.unit,
            speed=drive.speed if drive.speed_curve is None else None,
        )


@dataclass(frozen=True)
class Moving(Pickled):
    """The motion of a scene without a follower, for the picture of a motion.

    Attributes
    ----------
    name : of the design.
    unit : of length of the scene.
    pictured : the motion.
    """

    name: str
    unit: LengthUnit
    pictured: PicturedMotion
