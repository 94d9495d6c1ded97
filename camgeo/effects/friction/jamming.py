"""The margin of the follower against jamming.

If the contact force is too oblique, a harder push only presses the follower harder into its guide
or bearing, and does not move it (Rothbart, Cam Design Handbook, chapter 6, largest pressure angle
of a translating follower; Norton, Cam Design and Manufacturing Handbook, chapter 7, on pressure
angles; Volmer, Kurvengetriebe, on the transmission angle).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column
from camgeo.effects.friction.statics import Statics
from camgeo.effects.touching import holds_both_ways
from camgeo.effects.wording import at, between
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_lowest, stretch_below

if TYPE_CHECKING:
    from camgeo.check.finding import Severity

NEAR: Final = math.radians(5.0)
"""A smaller margin [rad] gives a warning: the usual scatter of friction coefficients, 0.1 to 0.2,
is about 5 degrees of the friction angle."""

ROUNDING: Final = 1e-12
"""A margin [rad] up to this is 0: a rounded transmission angle of 0."""

UNDRIVEN: Final = math.pi
"""Placeholder for the margin [rad] where the cam does not push; larger than any margin."""

WORDING: Final = {
    "roller": (
        (
            "transmission angle above the jamming limit by at least {value:.4f} deg, closest to it"
            " {place}"
        ),
        "transmission angle is below the limit",
    ),
    "face": (
        (
            "the contact force may lean at least {value:.4f} deg further before the follower jams,"
            " closest to jamming {place}"
        ),
        "contact force leans too far",
    ),
}
"""Sentence for the margin, and the fault if there is none. On a flat face the direction of the
contact force is fixed."""


def margin_of(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) [rad] margin for the flank with which the cam drives the follower.

    That is the flank on which the roller runs. In a groove, or between two discs, it is the one
    that pushes in the direction of motion, and the inner or main one during a dwell.
    """
    contact = statics.subject.cam.contact
    if not holds_both_ways(statics.subject):
        return statics.margin(phi, side, contact.push)
    inner, outer = (statics.margin(phi, side, sense) for sense in (1, -1))
    return np.where(_drive(statics, phi, side) < 0.0, outer, inner)


def _drive(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) +1 where the inner flank drives the follower, -1 where the other does, 0 in a dwell."""
    sine = statics.state(phi, side, 1).sine
    return np.where(sine < 0.0, -1.0, 1.0) * statics.senses(phi, side)


def column(statics: Statics, borders: FloatArray) -> Column:
    """The margin over the cam angle [deg]."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.degrees(margin_of(statics, phi, side))

    return Column("jamming margin", "deg", values, 0.0, borders)


def jamming_margin(statics: Statics, edges: FloatArray) -> tuple[Finding, ...]:
    """The smallest margin where the cam pushes the follower; no finding if it never does.

    `edges` (k,) are the cam angles [rad] from 0 to 2 pi between which the margin is smooth.
    """
    contact, both = statics.subject.cam.contact, holds_both_ways(statics.subject)

    def driven(phi: FloatArray, side: Side) -> FloatArray:
        drive = _drive(statics, phi, side)
        pushes = drive != 0.0 if both else drive == contact.push
        return np.where(pushes, margin_of(statics, phi, side), UNDRIVEN)

    lowest = piecewise_lowest(driven, edges)
    if lowest.value == UNDRIVEN:
        return ()
    value, near = math.degrees(lowest.value), math.degrees(NEAR)
    sentence, fault = WORDING[statics.subject.cam.follower.touching]
    sentence = sentence.format(value=value, place=at(lowest.place))
    severity: Severity = "ok"
    limit = near
    cam_range = None
    if lowest.value <= ROUNDING:
        severity, limit = "broken", 0.0
        cam_range = stretch_below(lambda phi: driven(phi, "right") - ROUNDING, edges, lowest.place)
        sentence = f"the follower jams: the {fault} by {-value:.4f} deg {at(lowest.place)}"
        if cam_range is not None:
            sentence += f", and {between(cam_range)}"
    elif lowest.value < NEAR:
        severity = "warning"
        sentence += f", less than {near:g} deg"
    return (
        Finding(
            name="jamming-margin",
            severity=severity,
            sentence=sentence,
            value=value,
            limit=limit,
            unit="deg",
            cam_angle=lowest.place,
            cam_range=cam_range,
        ),
    )
