"""Basic rating life of the roller bearing.

L10 = (C/P)^p million turns of the roller, p = 10/3 for roller bearings and 3 for ball bearings (ISO
281:2007, basic rating life), with the dynamic load rating C and the equivalent load P. Under a
varying load, damage is proportional to its p-th power and to the turns made under it (Palmgren and
Miner), so P^p is the mean of F^p over the turns of the roller: with F and the rate nu of the roller
per cam angle,

    P^p = int F^p |nu| dphi / int |nu| dphi.

The roller rolls on its flank without slip. Relative to the turning cam its centre moves along the
flank by |Z'| per cam angle, and the follower turns at the rate chi' in the fixed frame. So the
roller turns relative to its pin at nu = |Z'|/r_R - s (1 - sigma chi') per cam angle, with s = +1 on
the inner flank and -1 on the outer one, and the sense of rotation sigma (composition of the angular
velocities of roller, cam and follower).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.contact_pressure.line_contact import LineContact
from camgeo.effects.contact_pressure.table import Bearing
from camgeo.effects.wording import missed
from camgeo.motion.time_course import TimeCourse, period
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

EXPONENTS: Final[Mapping[Bearing, float]] = {"roller": 10.0 / 3.0, "ball": 3.0}
"""p of the bearings."""

TURNS: Final = 1e6
"""Turns of the roller that a bearing withstands under its load rating."""


@dataclass(frozen=True, slots=True)
class Life:
    """The life of the bearing.

    Attributes
    ----------
    load : P [N].
    speed : mean rate at which the roller turns on its pin [rad/s].
    seconds : L10 [s]; None if unlimited, because there is no load.
    load_error, speed_error, error : estimates of the relative errors of `load`, `speed` and
        `seconds`.
    """

    load: float
    speed: float
    seconds: float | None
    load_error: float
    speed_error: float
    error: float


def spin(contact: LineContact, phi: FloatArray, side: Side, sense: FloatArray) -> FloatArray:
    """(n,) nu, turns of the roller on its pin per turn of the cam, positive if it rolls forwards.

    `sense` (n,) is s, the flank on which it rolls.
    """
    subject = contact.subject
    relative = subject.state.curve.relative_jet(phi, side, order=1)
    rolling = np.hypot(relative.u, relative.v) / subject.cam.follower.roller_radius
    return np.asarray(rolling - sense * (1.0 - subject.cam.rotation * relative.turning))


def rolling_life(
    contact: LineContact,
    edges: FloatArray,
    course: TimeCourse,
    rating: float,
    exponent: float,
    tolerance: float,
) -> Life:
    """The life for the dynamic load rating `rating` [N] and p `exponent`, to the relative
    `tolerance`.

    Force and motion are smooth between neighbouring `edges` (k,) [rad] from 0 to 2 pi.

    Raises
    ------
    EffectError
        If the integrals do not reach the tolerance.
    """

    def turning(phi: FloatArray) -> FloatArray:
        return spin(contact, phi, "right", contact.carried(phi, "right")[1])

    def wear(phi: FloatArray) -> FloatArray:
        load, sense = contact.carried(phi, "right")
        turns = np.abs(spin(contact, phi, "right", sense))
        return np.asarray((load / rating) ** exponent * turns)

    share = 0.5 * tolerance  # the estimate also contains the rounding of the sum
    borders = merged(np.concatenate((edges, roots_on_grid(turning, grid_of(edges)))))
    turns = piecewise_integral(lambda phi: np.abs(turning(phi)), borders, share)
    worn = piecewise_integral(wear, borders, share)
    duration = period(course)
    speed = turns.value / duration
    turned = turns.error / turns.value
    if not worn.value > 0.0:
        return Life(0.0, speed, None, 0.0, turned, 0.0)
    error = worn.error / worn.value
    if max(error, turned) > tolerance:
        raise missed("the life of the roller bearing", max(error, turned), "itself", tolerance)
    return Life(
        load=rating * (worn.value / turns.value) ** (1.0 / exponent),
        speed=speed,
        seconds=TURNS * TURN * duration / worn.value,
        load_error=(error + turned) / exponent,
        speed_error=turned,
        error=error,
    )
