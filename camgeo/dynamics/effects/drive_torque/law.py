"""The torque on the camshaft as a function of speed and acceleration of the cam.

At a given cam angle the contact must provide the generalised force R = c0 + c1 omega + c2 omega^2 +
c3 alpha on the follower's coordinate q. By virtual work this takes the torque R q' on the camshaft
if there is no friction. With friction, the normal force N on a flank (sense = +1 for the inner one,
-1 for the outer one) provides the force |N| (sense * leverage + f) and takes the torque |N| (sense
* leverage * q' + m), where f and m are the contributions of friction per unit of |N|. So

    T = R (sense * leverage * q' + m) / (sense * leverage + f),

and the flank that carries follows from the sign of R. T is a linear function of R on either side of
R = 0, and continuous there. Friction in pivot or guide, which their whole load has a part in, is no
part of f then: |N| is the root of `camgeo.dynamics.effects.bearing_friction`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from camgeo.dynamics.effects.bearing_friction import (
    LINEAR,
    BearingFriction,
    RubbingLaw,
    linear_law,
    with_force,
    with_reversals,
)
from camgeo.dynamics.effects.contact import INNER, OUTER, carrier, leverage_of
from camgeo.dynamics.effects.effect import Subject
from camgeo.dynamics.effects.forces import at_rates, rates_of, smooth_edges
from camgeo.dynamics.effects.results import ContactForce
from camgeo.dynamics.effects.wording import at
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of, roots_on_grid
from camgeo.units import TURN


@dataclass(frozen=True, slots=True, eq=False)
class TorqueLaw:
    """The torque as a function of cam angle, speed and acceleration.

    Attributes
    ----------
    subject : the design.
    contact : the contact force, and the forces that it balances.
    """

    subject: Subject
    contact: ContactForce

    def coefficients(self, phi: FloatArray, side: Side) -> FloatArray:
        """(6, n) c0 to c3 of R, then T / R [N mm per unit of R] for R > 0 and for R < 0.

        T / R is nan where the follower would jam with an R of this sign. With friction in pivot or
        guide it is the rows of a `RubbingLaw`.
        """
        if self.contact.bearings is not None:
            return self._rubbing(self.contact.bearings, phi, side).rows
        out = np.empty((LINEAR, len(phi)))
        out[:4] = self.contact.required(phi, side)
        velocity = self.subject.state.motion.jet(phi, side, 1)[1]
        friction = self.contact.friction
        if friction is None:
            out[4:] = velocity
            return out
        levers = {sense: leverage_of(self.subject, phi, side, sense) for sense in (INNER, OUTER)}
        gains = {
            sense: _gain(lever, velocity, friction.per_normal(phi, side, sense))
            for sense, lever in levers.items()
        }
        outwards = levers[INNER] >= 0.0
        out[4] = np.where(outwards, gains[1], gains[-1])
        out[5] = np.where(outwards, gains[-1], gains[1])
        return out

    def _rubbing(self, bearings: BearingFriction, phi: FloatArray, side: Side) -> RubbingLaw:
        """The law with friction in the bearings."""
        velocity = self.subject.state.motion.jet(phi, side, 1)[1]
        drag, friction = bearings.drag(phi, side), self.contact.friction
        assert friction is not None  # that of the bearings is part of it
        found = {}
        for sense in (INNER, OUTER):
            lever = leverage_of(self.subject, phi, side, sense)
            loads = bearings.rubbing.per_normal(phi, side, sense)
            force, torque = friction.per_normal(phi, side, sense)
            free = lever + force + drag * np.sum(np.abs(loads), axis=0)
            found[sense] = (lever * velocity + torque, free, loads)
        outwards = leverage_of(self.subject, phi, side, INNER) >= 0.0
        torque, free, per = (
            np.stack((np.where(outwards, inner, outer), np.where(outwards, outer, inner)))
            for inner, outer in zip(found[INNER], found[OUTER], strict=True)
        )
        return RubbingLaw(
            self.contact.required(phi, side), torque, free, drag, bearings.own(phi, side), per
        )

    def at(
        self, phi: FloatArray, side: Side, omega: FloatArray | float, alpha: FloatArray | float
    ) -> FloatArray:
        """(n,) torque [N mm] at `phi` with the cam turning at omega [rad/s] and alpha [rad/s^2], of
        a rigid train.

        Raises
        ------
        EffectError
            "jamming", if friction prevents any contact force from driving the follower.
        """
        shape = np.zeros(phi.shape)
        rates = np.stack((omega + shape, alpha + shape))
        return self._at(rates, self.coefficients(phi, side), phi)

    def _at(self, rates: FloatArray, rows: FloatArray, phi: FloatArray) -> FloatArray:
        """(n,) torque [N mm] at `rates` (2, n) by the law `rows`, see `coefficients`."""
        law = linear_law(rows, rates[0], rates[1])
        return self._under(at_rates(law[:4], rates), law, phi)

    def _under(self, force: FloatArray, law: FloatArray, phi: FloatArray) -> FloatArray:
        """(n,) torque [N mm] where the contact provides R = `force` (n,)."""
        gain = np.where(force >= 0.0, law[4], law[5])
        torque: FloatArray = np.where(force == 0.0, 0.0, force * gain)
        jammed = np.isnan(torque)
        if np.any(jammed):
            self._refuse(phi[jammed][:1])
        return torque

    def _refuse(self, here: FloatArray) -> NoReturn:
        """Raise EffectError that the follower jams at the cam angle `here` (1,) [rad]."""
        curves = [carrier(self.subject, sense)[0].state.curve for sense in (INNER, OUTER)]
        angle = math.degrees(min(curve.transmission_angle(here)[0] for curve in curves))
        place = float(here[0]) % TURN
        raise EffectError(
            f"the follower jams {at(place)}: at a transmission angle of {angle:.4f} deg friction"
            " absorbs the entire contact force",
            finding="jamming",
            value=angle,
            unit="deg",
            cam_angle=place,
        )

    def torque(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] at the speed of the scene; the static part if it gives none."""
        rows, contact = self.coefficients(phi, side), self.contact
        if contact.bearings is None:
            return self._under(contact.demand(phi, side), rows, phi)
        for force in contact.forces:
            if force.present:
                rows = with_force(rows, contact.bearings, force, phi, side)
        return self._at(rates_of(self.subject, phi, side), rows, phi)

    def static(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] at very low speed: without inertia and viscous friction."""
        return self.at(phi, side, 0.0, 0.0)

    def dynamic(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] the part that the speed adds to the static part."""
        return self.torque(phi, side) - self.static(phi, side)

    def static_edges(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula of the static part changes.

        With friction these include the angles at which its R changes sign, or a force at an end of
        a guide.
        """
        base = smooth_edges(self.subject.state.smooth_angles, self.contact.lasting)
        if self.contact.friction is None:
            return base

        def released(phi: FloatArray) -> FloatArray:
            return self.contact.released(phi, "right", np.zeros((2, len(phi))))

        edges = merged(np.concatenate((base, roots_on_grid(released, grid_of(base)))))
        if self.contact.bearings is None or self.subject.cam.follower.pivot is not None:
            return edges

        def loads(phi: FloatArray) -> FloatArray:
            law = RubbingLaw.of(self.coefficients(phi, "right"))
            return np.asarray(law.loads(0.0, 0.0).real)

        return with_reversals(loads, edges)


def _gain(lever: FloatArray, velocity: FloatArray, per_normal: FloatArray) -> FloatArray:
    """(n,) T / R, with `lever` = sense * leverage; nan where the follower jams."""
    force = lever + per_normal[0]
    jams = (force == 0.0) | ((force * lever <= 0.0) & (velocity != 0.0))
    torque = lever * velocity + per_normal[1]
    return np.where(jams, np.nan, torque / np.where(jams, 1.0, force))
