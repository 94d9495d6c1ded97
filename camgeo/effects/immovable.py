"""Masses that no finite force moves: where the velocity jumps, and behind a locked linkage."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.errors import EffectError
from camgeo.wording import at_cam_angles

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.mechanism.linkage_protocol import Member
    from camgeo.numeric.arrays import FloatArray

JUMP: Final = 1e-9
"""A jump of the velocity by less than this share of the largest is rounding."""

POSES: Final[dict[Member, tuple[str, str, str]]] = {
    "slider": (
        "the coupler is square to the guide of the slider",
        "stroke",
        "the rocker cannot move the slider",
    ),
    "lever": ("coupler and lever are in line", "angle", "the rocker cannot move the lever"),
    "crank": ("crank and coupler are in line", "angle", "the slider cannot turn the crank"),
}
"""The pose of the linkage, the kind of its position, and what the follower cannot do, by the member
at the far end."""


def shocks(subject: Subject, mass: Quantity | None) -> list[float]:
    """The cam angles [rad] at which the velocity of the `mass` (n,) jumps, which is reduced to the
    follower; none without masses.
    """
    if mass is None:
        return []
    jumps = subject.state.shocks
    return [phi for phi in jumps if mass(np.array([phi]), "right")[0] > 0.0]


def torque_shocks(subject: Subject, per_alpha: Quantity, edges: FloatArray) -> FloatArray:
    """(k,) the cam angles [rad] at which the torque on the camshaft is infinite.

    There the velocity of the follower jumps and `per_alpha` is not 0: the inertia
    reduced to it, or the derivative of its force by the acceleration of the cam. The follower moves
    between `edges` (m,) [rad].
    """
    motion = subject.state.motion
    places = np.asarray(motion.breaks)
    if not len(places):
        return places
    jump = np.abs(motion.jet(places, "right", 1)[1] - motion.jet(places, "left", 1)[1])
    inside = np.abs(motion.jet(edges[:-1] + 0.5 * np.diff(edges), "right", 1)[1])
    heavy = (per_alpha(places, "left") != 0.0) | (per_alpha(places, "right") != 0.0)
    hit: FloatArray = places[
        heavy & (jump > JUMP * max(float(np.max(inside)), float(np.max(jump))))
    ]
    return hit


def refuse_locked(subject: Subject, burden: str) -> None:
    """Raise EffectError if the follower cannot move the far end of its linkage at some cam angle.

    `burden` completes the sentence with what acts there, e.g. "'s mass" or " against its load".
    """
    linkage = subject.drive.linkage
    if linkage is None:
        return
    from camgeo.mechanism.positions import locked_at

    locked = locked_at(linkage, subject.state.output)
    if locked is None:
        return
    pose, what, cannot = POSES[linkage.member]
    phi, position = locked
    value, unit = (position, "mm") if linkage.unit == "mm" else (math.degrees(position), "deg")
    raise EffectError(
        f"{pose} {at_cam_angles(phi)}, {what} {value:.6g} {unit}:"
        f" {cannot}{burden} there, whatever the force; the {what} must stay clear of this value",
        finding=f"locked-{linkage.member}",
        value=value,
        unit=unit,
        cam_angle=phi,
    )
