"""Arcs as controllers take them: centre and sweep from what a block states."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo.units import TURN

NO_ARC: Final = 5e-7
"""Sweep [rad] up to which Grbl makes a full circle of an arc (ARC_ANGULAR_TRAVEL_EPSILON in its
config.h): its printed ends are the same point, nearly."""

NEARLY_FULL: Final = math.radians(1.0)
"""An arc that lacks less to a full circle is a short one the wrong way round, probably."""

AMBIGUOUS: Final = math.radians(15.0)
"""An arc given by its radius is ill defined so near to half a turn and to a whole one: from 165 to
195 degrees and above 345 (LinuxCNC, docs/src/gcode/g-code.adoc, "Radius Format Arcs")."""


@dataclass(frozen=True, slots=True)
class Arc:
    """An arc in the plane.

    Attributes
    ----------
    centre : [mm].
    sweep : angle turned [rad], positive counter-clockwise; with further turns more than a circle.
    mismatch : difference of the radii at its ends [mm].
    """

    centre: complex
    sweep: float
    mismatch: float


def swept(start: complex, end: complex, centre: complex, *, ccw: bool, turns: int = 0) -> Arc:
    """The arc about a centre; where its ends coincide it is a full circle."""
    first, last = start - centre, end - centre
    turn = phase(last / first) % TURN if first and last else 0.0
    if start == end or not (first and last):
        turn = TURN
    elif not ccw:
        turn = turn - TURN if turn else -TURN
    sweep = abs(turn) + turns * TURN
    return Arc(centre, sweep if ccw else -sweep, abs(abs(first) - abs(last)))


def by_radius(start: complex, end: complex, radius: float, *, ccw: bool) -> Arc:
    """The arc of a radius, with a negative one the larger; half a circle where it is too small.

    How much too small is the mismatch.
    """
    chord = end - start
    half, size = 0.5 * abs(chord), abs(radius)
    height = math.sqrt(max(size * size - half * half, 0.0))
    left = ccw if radius > 0.0 else not ccw
    side = 1j if left else -1j
    centre = 0.5 * (start + end) + side * chord / abs(chord) * height
    arc = swept(start, end, centre, ccw=ccw)
    return Arc(centre, arc.sweep, max(half - size, 0.0))


def tangent(start: complex, end: complex, heading: complex) -> Arc | None:
    """The arc that goes on from a heading; None if that leads straight to the end, or back."""
    chord = end - start
    turn = 2.0 * phase(chord / heading) if chord and heading else 0.0
    if abs(math.sin(0.5 * turn)) < 1e-9:
        return None
    radius = 0.5 * abs(chord) / math.sin(0.5 * turn)  # positive to the left
    centre = start + 1j * heading / abs(heading) * radius
    return Arc(centre, turn, 0.0)


def heading_after(start: complex, end: complex, arc: Arc | None) -> complex:
    """The direction at the end of a move, of length 1; NaN if it has none in the plane."""
    if arc is not None:
        arm = (end - arc.centre) * (1j if arc.sweep > 0.0 else -1j)
        return arm / abs(arm) if arm else complex(math.nan, math.nan)
    way = end - start
    if cmath.isnan(way) or not way:
        return complex(math.nan, math.nan)
    return way / abs(way)


def about_pole(pole: complex, radius: float, angle: float) -> complex:
    """The point at polar coordinates about a pole; the angle in degrees."""
    return pole + cmath.rect(radius, math.radians(angle))
