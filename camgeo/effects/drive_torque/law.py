"""The torque on the camshaft as a function of speed and acceleration of the cam.

At a given cam angle the contact must provide the generalised force R = c0 + c1 omega + c2 omega^2 +
c3 alpha on the follower's coordinate q. By virtual work this takes the torque R q' on the camshaft
if there is no friction. With friction, the normal force N on a flank (sense = +1 for the inner one,
-1 for the outer one) provides the force |N| (sense * leverage + f) and takes the torque |N| (sense
* leverage * q' + m), where f and m are the contributions of friction per unit of |N|. So

    T = R (sense * leverage * q' + m) / (sense * leverage + f),

and the flank that carries follows from the sign of R. T is a linear function of R on either side of
R = 0, and continuous there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NoReturn

import numpy as np

from camgeo.effects.effect import Subject
from camgeo.effects.force import at_rates, smooth_edges
from camgeo.effects.results import ContactForce
from camgeo.effects.touching import INNER, OUTER, carrier, leverage_of
from camgeo.effects.wording import at
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

ROWS: Final = 6
"""Rows of the law: c0 to c3 of R, and the torque per unit of R for positive and negative R."""


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

        T / R is nan where the follower would jam with an R of this sign.
        """
        out = np.empty((ROWS, len(phi)))
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
        law = self.coefficients(phi, side)
        shape = np.broadcast_to(np.zeros(1), phi.shape)
        return self._under(at_rates(law[:4], np.stack((omega + shape, alpha + shape))), law, phi)

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
        force = self.contact.demand(phi, side)
        return self._under(force, self.coefficients(phi, side), phi)

    def static(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] at very low speed: without inertia and viscous friction."""
        return self.at(phi, side, 0.0, 0.0)

    def dynamic(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] the part that the speed adds to the static part."""
        return self.torque(phi, side) - self.static(phi, side)

    def static_edges(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula of the static part changes.

        With friction these include the angles at which its R changes sign.
        """
        base = smooth_edges(self.subject.state.smooth_angles, self.contact.lasting)
        if self.contact.friction is None:
            return base
        roots = roots_on_grid(lambda phi: self.contact.required(phi, "right")[0], grid_of(base))
        return merged(np.concatenate((base, roots)))


def _gain(lever: FloatArray, velocity: FloatArray, per_normal: FloatArray) -> FloatArray:
    """(n,) T / R, with `lever` = sense * leverage; nan where the follower jams."""
    force = lever + per_normal[0]
    jams = (force == 0.0) | ((force * lever <= 0.0) & (velocity != 0.0))
    torque = lever * velocity + per_normal[1]
    return np.where(jams, np.nan, torque / np.where(jams, 1.0, force))
