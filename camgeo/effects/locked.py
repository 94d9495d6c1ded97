"""Linkages whose follower cannot move what has a mass or a load at their far end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from camgeo.errors import EffectError

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.mechanism.linkage_protocol import Member

POSES: Final[dict[Member, tuple[str, str, str]]] = {
    "slider": (
        "the coupler is square to the guide of the slider",
        "stroke",
        "the rocker cannot move the slider",
    ),
    "lever": ("coupler and lever are in line", "angle", "the rocker cannot move the lever"),
    "crank": ("crank and coupler are in line", "angle", "the slider cannot turn the crank"),
}
"""How the linkage stands, what its positions are, and what the follower cannot do; by the member at
the far end."""


def refuse_locked(subject: Subject, burden: str) -> None:
    """Raise EffectError if the follower cannot move the far end of its linkage somewhere.

    `burden` is what it would have to be moved with, as the sentence goes on: "'s mass".
    """
    linkage = subject.cam.drive.linkage
    if linkage is None:
        return
    from camgeo.mechanism.positions import locked_at

    locked = locked_at(linkage, subject.cam.drive.plan)
    if locked is None:
        return
    pose, what, cannot = POSES[linkage.member]
    phi, position = locked
    value, unit = (position, "mm") if linkage.unit == "mm" else (math.degrees(position), "deg")
    raise EffectError(
        f"{pose} at cam angle {math.degrees(phi):.6g} deg, {what} {value:.6g} {unit}:"
        f" {cannot}{burden} there, at whatever force; the {what} must keep clear of it",
        finding=f"locked-{linkage.member}",
        value=value,
        unit=unit,
        cam_angle=phi,
    )
