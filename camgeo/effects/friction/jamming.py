"""How far the follower is from jamming.

A cam that pushes the follower by a force of too flat a direction presses it the more into its guide
or bearing the harder it pushes, and does not move it (Rothbart, Cam Design Handbook, chapter 6,
largest pressure angle of a translating follower; Norton, Cam Design and Manufacturing Handbook,
chapter 7, on pressure angles; Volmer, Kurvengetriebe, on the transmission angle).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column
from camgeo.effects.friction.statics import Statics
from camgeo.effects.told import between
from camgeo.effects.touching import holds_both_ways
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import piecewise_extremes, stretch_below
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.check.finding import Severity

NEAR: Final = math.radians(5.0)
"""A smaller margin [rad] is worth a warning: what coefficients of friction scatter by, 0.1 to
0.2, is some 5 degrees of the angle of friction."""

ROUNDING: Final = 1e-12
"""A margin [rad] up to this is none: a transmission angle of 0, rounded."""

UNDRIVEN: Final = math.pi
"""Stands for the margin [rad] where the cam does not push; no margin is as large."""

TOLD: Final = {
    "roller": (
        (
            "smallest transmission angle above the limit of jamming: by {value:.4f} deg at cam"
            " angle {angle:.4f} deg"
        ),
        "transmission angle misses the limit",
    ),
    "face": (
        (
            "the contact force may lean {value:.4f} deg more before the follower jams, least at cam"
            " angle {angle:.4f} deg"
        ),
        "contact force leans too far",
    ),
}
"""What is told of the margin, and what is wrong without one; the contact force always points the
same way on a flat face."""


def margin_of(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) [rad] margin of the flank by which the cam would push the follower on.

    That is the one on which the roller runs; of a groove, or of two discs, the one that pushes in
    the sense in which the follower moves, the inner or main one in a rest.
    """
    contact = statics.subject.cam.contact
    if not holds_both_ways(statics.subject):
        return statics.margin(phi, side, contact.push)
    inner, outer = (statics.margin(phi, side, sense) for sense in (1, -1))
    return np.where(_drive(statics, phi, side) < 0.0, outer, inner)


def _drive(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) +1 where the inner flank pushes the follower on, -1 where the other, 0 in a rest."""
    sine = statics.state(phi, side, 1).sine
    return np.where(sine < 0.0, -1.0, 1.0) * statics.senses(phi, side)


def column(statics: Statics, borders: FloatArray) -> Column:
    """The margin over the cam angle [deg]."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.degrees(margin_of(statics, phi, side))

    return Column("jamming margin", "deg", values, 0.0, borders)


def jamming_margin(statics: Statics, edges: FloatArray) -> tuple[Finding, ...]:
    """The smallest margin where the cam pushes the follower; none if it does so nowhere.

    `edges` (k,) are the cam angles [rad] from 0 to 2 pi between which the margin is smooth.
    """
    contact, both = statics.subject.cam.contact, holds_both_ways(statics.subject)

    def driven(phi: FloatArray, side: Side) -> FloatArray:
        drive = _drive(statics, phi, side)
        pushes = drive != 0.0 if both else drive == contact.push
        return np.where(pushes, margin_of(statics, phi, side), UNDRIVEN)

    lowest = piecewise_extremes(driven, edges).lowest
    if lowest.value == UNDRIVEN:
        return ()
    angle = math.degrees(lowest.place % TURN)
    value, near = math.degrees(lowest.value), math.degrees(NEAR)
    told, lacks = TOLD[statics.subject.cam.follower.touching]
    told = told.format(value=value, angle=angle)
    severity: Severity = "ok"
    limit = near
    cam_range = None
    if lowest.value <= ROUNDING:
        severity, limit = "broken", 0.0
        cam_range = stretch_below(lambda phi: driven(phi, "right") - ROUNDING, edges, lowest.place)
        told = f"the follower jams: the {lacks} by {-value:.4f} deg at cam angle {angle:.4f} deg"
        if cam_range is not None:
            told += f", and {between(cam_range)}"
    elif lowest.value < NEAR:
        severity = "warning"
        told += f", less than {near:g} deg"
    return (
        Finding(
            name="jamming-margin",
            severity=severity,
            sentence=told,
            value=value,
            limit=limit,
            unit="deg",
            cam_angle=lowest.place % TURN,
            cam_range=cam_range,
        ),
    )
