"""A motion as pictures show it, for which no cam is needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.files.pictured import PlanSketch
from camgeo.files.sketch import plan_sketch
from camgeo.numeric.arrays import FloatArray
from camgeo.pickled import Pickled
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.cam.drive import Drive, LiftUnit

LIFT = ("s", "s1", "s2", "s3")
"""Lift and its derivatives, as quantities."""


@dataclass(frozen=True)
class PicturedMotion(Pickled):
    """A `camgeo.files.pictured.PicturedDrive`.

    Attributes
    ----------
    drive : what moves the follower.
    lift_unit : of the follower's own motion.
    """

    drive: Drive
    lift_unit: LiftUnit

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) lift or a derivative at `phi` (n,) [rad], see `camgeo.files.pictured.Pictured`."""
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
    """A `camgeo.files.pictured.Moved`: the motion of a scene without a follower.

    Attributes
    ----------
    name : of the design.
    unit : of length of the scene.
    pictured : the motion.
    """

    name: str
    unit: LengthUnit
    pictured: PicturedMotion
