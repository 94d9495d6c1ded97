"""Conjugate cams: a second roller on the follower, driven by a second disc on the same shaft.

The main disc pushes the follower one way and the return disc pushes it back, so no spring is
needed. Both rollers are fixed to one carriage or one lever and share its motion; the return roller
is therefore a follower in its own right, with its own geometry and the same lift:

- on a carriage its centre is B_2 = B_1 - spacing g, g the direction of the guide, possibly on a
  parallel line: its guide points along -g, and what moves the main roller outward moves it inward;
- on a lever its arm is at a fixed angle to the main arm: same pivot, another triangle, same sense
  of swing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller, excess_of
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.mechanism.values import (
    Angle,
    Coordinate,
    Length,
    Radius,
    angle,
    coordinate,
    length,
    radius,
)
from camgeo.numeric.checked import instance
from camgeo.units import TURN

FLAT: Final = 1e-6
"""Angle [rad], and fraction of the spacing, by which the return roller must stay clear of where its
disc cannot drive it; closer than that, the geometry has lost six of its sixteen digits."""


@dataclass(frozen=True, slots=True)
class Mount:
    """How the return roller is fixed to the main one; what is not given follows the main roller.

    Attributes
    ----------
    make : `return_on_carriage` or `return_on_lever`.
    given : its arguments after the main roller, by their names.
    """

    make: Callable[..., Follower]
    given: tuple[tuple[str, float], ...]

    def roller(self, main: Follower) -> Follower:
        """The return roller; GeometryError as for `make`."""
        return self.make(main, **dict(self.given))

    def sized(self, **sizes: float) -> Mount:
        """The same with other arguments."""
        return Mount(self.make, tuple({**dict(self.given), **sizes}.items()))


def return_on_carriage(
    main: TranslatingRoller,
    spacing: Length,
    offset: Coordinate | None = None,
    roller_radius: Radius | None = None,
) -> TranslatingRoller:
    """The return roller on the carriage of `main`.

    Parameters
    ----------
    spacing : distance of the roller centres along the guide [mm], positive; the return roller lies
        behind the main one, on the other side of the cam axis.
    offset : e of the return roller [mm], positive on the same side of the cam axis as that of
        `main`; None for the same offset.
    roller_radius : [mm]; None for that of `main`.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.return.spacing" also if
        the return roller does not lie on the other side of the cam axis at cam angle 0.
    """
    instance("follower.kind", main, TranslatingRoller, "a roller on a carriage")
    spacing = length("follower.return.spacing", spacing)
    across = main.offset
    if offset is not None:
        across = coordinate("follower.return.offset", offset)
    size = _size(main, roller_radius)
    height = spacing - main.start_height
    if not height > FLAT * spacing:
        raise GeometryError(
            "the return roller must lie on the other side of the cam axis: the spacing must exceed"
            f" the height of the main roller over the cam axis at cam angle 0,"
            f" {main.start_height:.6g} mm",
            key="follower.return.spacing",
            value=f"{spacing:g}",
        )
    return TranslatingRoller(
        base_radius=math.hypot(across, height),
        roller_radius=size,
        offset=-across,  # seen along the opposite direction
        guide_angle=main.guide_angle + (math.pi if main.guide_angle <= math.pi else -math.pi),
        direction=-main.direction,
    )


def return_on_lever(
    main: OscillatingRoller,
    arm_angle: Angle,
    arm: Length | None = None,
    roller_radius: Radius | None = None,
) -> OscillatingRoller:
    """The return roller on the lever of `main`.

    Parameters
    ----------
    arm_angle : from the main arm to the return arm [rad], counter-clockwise positive.
    arm : pivot to return roller [mm]; None for the arm of `main`.
    roller_radius : [mm]; None for that of `main`.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.return.arm_angle" also if
        the return arm lies on the line from the pivot to the cam axis at cam angle 0: without a
        triangle its disc could not move it.
    """
    instance("follower.kind", main, OscillatingRoller, "a roller on a lever")
    arm_angle = angle("follower.return.arm_angle", arm_angle)
    own = main.arm if arm is None else length("follower.return.arm", arm)
    size = _size(main, roller_radius)
    chi = math.remainder(main.arm_side * main.start_angle + arm_angle, TURN)
    side = 1 if chi > 0.0 else -1
    # |A_0 B_2| by the law of cosines, in the form that stays accurate for small angles.
    apart = 4.0 * main.centre_distance * own * math.sin(0.5 * chi) ** 2
    base_radius = math.sqrt(excess_of(main.pivot, own) ** 2 + apart)
    flat = not FLAT < abs(chi) < math.pi - FLAT
    try:
        if not flat:
            return OscillatingRoller(
                pivot=main.pivot,
                arm=own,
                base_radius=base_radius,
                roller_radius=size,
                arm_side=side,
                direction=None if main.direction is None else main.swing_sense * side,
            )
    except GeometryError:
        pass  # a triangle that is flat up to rounding
    raise GeometryError(
        "the return arm lies on the line from the pivot to the cam axis at cam angle 0, where its"
        f" disc cannot move it: the main arm is at {math.degrees(main.start_angle):.6g} degrees"
        f" {'counter-clockwise' if main.arm_side > 0 else 'clockwise'} of that line",
        key="follower.return.arm_angle",
        value=f"{math.degrees(arm_angle):g}",
    )


def _size(main: TranslatingRoller | OscillatingRoller, roller_radius: float | None) -> float:
    if roller_radius is None:
        return main.roller_radius
    return radius("follower.return.roller_radius", roller_radius)
