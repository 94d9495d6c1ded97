"""Exact sensitivities: how far the machine's position errs per unit of a dimension.

By virtual displacements, see `camgeo.tolerancing.machine`; nothing is sampled but the cam angle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray
from camgeo.tolerancing.far_end import FarEnd
from camgeo.tolerancing.freedoms import Unit, Way
from camgeo.tolerancing.machine import Machine, Nominal


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Of a machine at cam angles.

    Attributes
    ----------
    machine : the nominal one.
    phi : (n,) cam angles [rad].
    """

    machine: Machine
    phi: FloatArray

    @cached_property
    def nominal(self) -> Nominal:
        """The contact."""
        return self.machine.nominal(self.phi)

    @cached_property
    def lifts(self) -> Jet:
        """(4, n) of the follower, and derivatives."""
        return self.machine.cam.drive.motion.jet(self.phi)

    @cached_property
    def positions(self) -> Jet:
        """(4, n) of the far end, or of the follower if there is no linkage."""
        return self.machine.cam.drive.plan.jet(self.phi)

    @cached_property
    def far_end(self) -> FarEnd | None:
        """Of the linkage, if there is one."""
        linkage = self.machine.linkage
        return None if linkage is None else FarEnd.of(linkage)

    def of(self, unit: Unit) -> FloatArray:
        """(n,) error of the position [mm or rad] per unit of a dimension [mm or rad].

        Raises GeometryError with key "linkage" where the follower cannot move the far end.
        """
        follower = self.of_follower(unit)
        if self.far_end is None:
            return follower
        return self.far_end.sensitivity(unit, self.lifts[0], self.positions[0], follower)

    def of_follower(self, unit: Unit) -> FloatArray:
        """(n,) error of the follower's own lift, where this side carries it."""
        if not unit.freedom.met_by(self.machine.hold):
            return np.zeros(len(self.phi))
        if unit.freedom.way is Way.SETTING:
            return np.full(len(self.phi), -unit.factor.real / self._setting)
        return self._pushed(unit) / self.nominal.leverage

    @property
    def _setting(self) -> float:
        """Rate of the radius at lift 0, at which it is the base radius, per unit of lift.

        Raises GeometryError if it is 0.
        """
        pose = self.machine.pose
        place = complex(pose.start[0, 0])
        rate = complex(pose.velocity(pose.start)[0, 0])
        found = (place.conjugate() * rate).real / abs(place)
        if found == 0.0:
            message = "does not say where the follower is: at lift 0 it is nearest to the cam axis"
            raise GeometryError(message, "follower.base_radius")
        return found

    def _pushed(self, unit: Unit) -> FloatArray:
        """(n,) [mm] n . (dR - dW) per unit."""
        nominal, pose = self.nominal, self.machine.pose
        factor = unit.factor
        match unit.freedom.way:
            case Way.GROWTH:
                return np.full(len(self.phi), factor.real)
            case Way.WAVE:
                later = np.pi if self.machine.half_turn else 0.0
                turned = np.exp(-1j * unit.freedom.waves * (self.phi + later))
                return np.asarray((factor * turned).real)
            case Way.SEAT:
                return nominal.across(factor * nominal.turn)
            case Way.TIMING:
                turn = 1j * self.machine.cam.rotation * nominal.places
                return factor.real * nominal.across(turn)
            case Way.SHAFT:
                return nominal.across(factor)
            case Way.PIVOT:
                return -nominal.across(factor)
            case Way.BODY:
                return -nominal.across(factor * pose.turned(self.lifts[0]))
            case Way.TILT:
                return -factor.real * nominal.across(1j * nominal.places)
        return np.zeros(len(self.phi))
