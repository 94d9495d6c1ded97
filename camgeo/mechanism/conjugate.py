"""Conjugate cams: the second roller of a follower, which a second disc on the same shaft drives.

The main disc pushes the follower one way, the return disc pushes it back, so that no spring is
needed. Both rollers are fixed to one carriage or one lever and make one motion; the return roller
is therefore a follower of its own, with the geometry of where it sits and the same lift:

- on a carriage its centre is B_2 = B_1 - spacing g, g the guide's direction, perhaps on a parallel
  line: a guide in the direction -g, on which what moves the main roller outward moves it inward;
- on a lever its arm makes a fixed angle with the main arm: the same pivot, another triangle, the
  same sense of swing.
"""

from __future__ import annotations

import math
from typing import Final

from camgeo.errors import GeometryError
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.units import TURN

FLAT: Final = 1e-6
"""Angle [rad], and share of the spacing, by which the return roller must keep off the places where
its disc cannot drive it; nearer to them the geometry has lost six of its sixteen digits."""


def return_on_carriage(
    main: TranslatingRoller,
    spacing: float,
    offset: float | None = None,
    roller_radius: float | None = None,
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
        With key "follower.return.spacing", if the return roller does not lie on the other side of
        the cam axis at cam angle 0.
    """
    across = main.offset if offset is None else offset
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
        roller_radius=main.roller_radius if roller_radius is None else roller_radius,
        offset=-across,  # looked at along the other direction
        guide_angle=main.guide_angle + math.pi,
        direction=-main.direction,
    )


def return_on_lever(
    main: OscillatingRoller,
    arm_angle: float,
    arm: float | None = None,
    roller_radius: float | None = None,
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
        With key "follower.return.arm_angle", if the return arm lies on the line from the pivot to
        the cam axis at cam angle 0: there is no triangle, and its disc could not move it.
    """
    length = main.arm if arm is None else arm
    chi = math.remainder(main.arm_side * main.start_angle + arm_angle, TURN)
    side = 1 if chi > 0.0 else -1
    # |A_0 B_2| by the law of cosines, in the form that keeps its digits for small angles.
    apart = 4.0 * main.centre_distance * length * math.sin(0.5 * chi) ** 2
    base_radius = math.sqrt((main.centre_distance - length) ** 2 + apart)
    flat = not FLAT < abs(chi) < math.pi - FLAT
    try:
        if not flat:
            return OscillatingRoller(
                pivot=main.pivot,
                arm=length,
                base_radius=base_radius,
                roller_radius=main.roller_radius if roller_radius is None else roller_radius,
                arm_side=side,
                direction=None if main.direction is None else main.swing_sense * side,
            )
    except GeometryError:
        pass  # a triangle that is flat but for rounding
    raise GeometryError(
        "the return arm lies on the line from the pivot to the cam axis at cam angle 0, where its"
        f" disc cannot move it: the main arm is at {math.degrees(main.start_angle):.6g} degrees"
        f" {'counter-clockwise' if main.arm_side > 0 else 'clockwise'} of that line",
        key="follower.return.arm_angle",
        value=f"{math.degrees(arm_angle):g}",
    )
