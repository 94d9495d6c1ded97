"""Arcs as controllers take them: centre and sweep from what a block states."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo.units import TURN
from camgeo_export.interpreter.block import ARMS, AXES

NO_ARC: Final = 5e-7
"""Sweep [rad] up to which Grbl makes a full circle of an arc (ARC_ANGULAR_TRAVEL_EPSILON in its
config.h): its printed ends are the same point, nearly."""

NEARLY_FULL: Final = math.radians(1.0)
"""An arc that lacks less to a full circle is a short one the wrong way round, probably."""

CHORDS: Final = 1e-3
"""How far chords of an arc in another plane than XY may be off it [mm]."""

SHORTEST: Final = math.radians(0.1)
"""Sweep of the shortest chord [rad]: beyond a radius of 2.6 m chords are off by more."""

AMBIGUOUS: Final = math.radians(15.0)
"""An arc given by its radius is ill defined so near to half a turn and to a whole one: from 165 to
195 degrees and above 345 (LinuxCNC, docs/src/gcode/g-code.adoc, "Radius Format Arcs")."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane of arcs: two axes, by their places in XYZ, and the one across."""

    first: int
    second: int
    across: int

    @property
    def arms(self) -> str:
        """Letters of an arc's centre in it."""
        return ARMS[self.first] + ARMS[self.second]

    @property
    def axes(self) -> str:
        """Letters of its coordinates."""
        return AXES[self.first] + AXES[self.second]

    def drop(self, at: complex, z: float) -> tuple[complex, float]:
        """A point in the coordinates of the plane, and its height over it."""
        point = (at.real, at.imag, z)
        return complex(point[self.first], point[self.second]), point[self.across]

    def lift(self, place: complex, height: float) -> tuple[complex, float]:
        """The point at a place of the plane: X and Y, and Z."""
        point = [0.0, 0.0, 0.0]
        point[self.first], point[self.second] = place.real, place.imag
        point[self.across] = height
        return complex(point[0], point[1]), point[2]


PLANES: Final = {"plane XY": Plane(0, 1, 2), "plane ZX": Plane(2, 0, 1), "plane YZ": Plane(1, 2, 0)}
"""By what G17, G18 and G19 mean; in each G3 turns from the first axis to the second."""


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


def by_radius(start: complex, end: complex, radius: float, *, ccw: bool, turns: int = 0) -> Arc:
    """The arc of a radius, with a negative one the larger; half a circle where it is too small.

    How much too small is the mismatch.
    """
    chord = end - start
    half, size = 0.5 * abs(chord), abs(radius)
    height = math.sqrt(max(size * size - half * half, 0.0))
    left = ccw if radius > 0.0 else not ccw
    side = 1j if left else -1j
    centre = 0.5 * (start + end) + side * chord / abs(chord) * height
    arc = swept(start, end, centre, ccw=ccw, turns=turns)
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


def rounded(
    start: complex, corner: complex, end: complex, radius: float
) -> tuple[complex, complex, Arc] | None:
    """Ends of the arc that rounds a corner of two lines, and the arc; None if it does not fit."""
    way, onward = corner - start, end - corner
    if cmath.isnan(way) or cmath.isnan(onward) or not (way and onward):
        return None
    turn = phase(onward / way)
    cut = radius * math.tan(0.5 * abs(turn))
    if not 0.0 < cut <= min(abs(way), abs(onward)):
        return None
    first = corner - way / abs(way) * cut
    last = corner + onward / abs(onward) * cut
    centre = first + way / abs(way) * radius * (1j if turn > 0.0 else -1j)
    return first, last, Arc(centre, turn, 0.0)


def chords(start: complex, end: complex, arc: Arc) -> list[complex]:
    """Ends of chords along an arc, from its radius at the start to that at its end."""
    first, last = start - arc.centre, end - arc.centre
    size = max(abs(first), abs(last), CHORDS)
    count = math.ceil(abs(arc.sweep) / max(2.0 * math.acos(1.0 - CHORDS / size), SHORTEST))
    grown = (abs(last) / abs(first) - 1.0) / max(count, 1)
    found = [
        arc.centre + first * (1.0 + k * grown) * cmath.exp(1j * arc.sweep * k / count)
        for k in range(1, count)
    ]
    return [*found, end]


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
