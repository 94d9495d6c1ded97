"""Necks: chords of the pitch curve at right angles to it at both ends, where two flanks touch.

A flank at the distance d touches itself where such a chord is 2 |d| long and d points into it, and
crosses itself where it is shorter. So global undercut is measured by a smooth number, whose root is
the limit, which need not be enclosed by trial.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.cures.conditions import Discs, angles_of, segment_at
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError

STEPS = 40
"""Most Newton steps; from a nearby crossing ten are plenty."""

LONGEST = 0.1
"""Longest Newton step [rad]: 6 degrees, so that it stays in the moves where it began."""

SQUARE = 1e-10
"""Largest cosine between chord and tangent that counts as a right angle; its square is rounding."""

TOGETHER = 1e-3
"""Ends closer than this [rad] are running into each other: between the ends of a neck the curve
makes half a turn, and where they meet their two equations become one."""

Pair = tuple[int, float, float]
"""A crossing of a flank in use: the number of its disc, and its two cam angles [rad] in
[0, 2 pi)."""

Pairs = tuple[Pair, ...]

Place = tuple[int, float]
"""A cam angle as the index of its segment in the plan and the fraction of the segment's span."""


@dataclass(frozen=True, slots=True)
class Neck:
    """A chord of the pitch curve at right angles to it at both ends.

    Attributes
    ----------
    disc : number of its disc.
    first, second : its ends; as fractions of segments they survive a change of the spans.
    clearance : its length minus twice the distance of the flanks from the pitch curve [mm].
    """

    disc: int
    first: Place
    second: Place
    clearance: float


def crossings(discs: Discs) -> Pairs:
    """The crossings of each flank with itself, see `camgeo.outline.crossings`."""
    from camgeo.outline.crossings import find_crossings  # only regular flanks need it

    return tuple(
        (number, each.first, each.second)
        for number, cam in enumerate(discs)
        for _, flank in cam.disc.flanks
        for each in find_crossings(flank)
    )


def narrowest(discs: Discs, pairs: Pairs) -> Neck | None:
    """The neck with the smallest clearance near the crossings; None if none is found."""
    necks = [neck for pair in pairs if (neck := _neck(discs, *pair)) is not None]
    return min(necks, key=lambda neck: neck.clearance, default=None)


def followed(discs: Discs, neck: Neck) -> Neck | None:
    """The same neck of changed discs; None if it cannot be followed."""
    cam = discs[neck.disc]
    return _neck(discs, neck.disc, _angle(cam, neck.first), _angle(cam, neck.second))


def _neck(discs: Discs, number: int, first: float, second: float) -> Neck | None:
    cam = discs[number]
    try:
        pitch = cam.disc.pitch_curve
        ends = _square_chord(pitch, first, second)
    except GeometryError:
        return None
    if ends is None:
        return None
    angles = np.array(ends)
    point, slope = pitch.jet(angles)[:2]
    chord = complex(point[1] - point[0])
    inward = 1j * pitch.rotation * slope / np.abs(slope) * np.array([1.0, -1.0])
    facing = (np.conj(chord) * inward).real
    # The flank lies in the chord at both its ends, or at neither.
    if not any(np.all(distance * facing > 0.0) for distance in cam.distances):
        return None
    clearance = abs(chord) - 2.0 * cam.disc.flank_distance
    return Neck(number, _place(cam, ends[0]), _place(cam, ends[1]), clearance)


def _square_chord(pitch: PitchCurve, first: float, second: float) -> tuple[float, float] | None:
    """Ends [rad] of a nearby shortest chord, by Newton's method; None if it does not converge."""
    angles = np.array([first, second])
    for _ in range(STEPS):
        if abs(math.remainder(float(angles[1] - angles[0]), math.tau)) < TOGETHER:
            return None
        point, slope, bend = pitch.jet(angles)[:3]
        chord = np.conj(complex(point[1] - point[0]))
        # Half the square of the chord's length, its gradient and its Hessian.
        sign = np.array([-1.0, 1.0])
        gradient = sign * (chord * slope).real
        speed = np.abs(slope)
        if np.all(np.abs(gradient) <= SQUARE * speed * abs(chord)):
            return float(angles[0]), float(angles[1])
        own = speed**2 + sign * (chord * bend).real
        mixed = -float((np.conj(slope[0]) * slope[1]).real)
        if min(own) <= 0.0 or own[0] * own[1] <= mixed**2:  # no minimum: go downhill
            own, mixed = speed**2, 0.0
        crosswise = own[::-1] * gradient - mixed * gradient[::-1]
        step = crosswise / (own[0] * own[1] - mixed**2)
        longest = float(np.max(np.abs(step)))
        if longest == 0.0:
            return None
        angles = angles - step * min(1.0, LONGEST / longest)
    return None


def _place(cam: Cam, angle: float) -> Place:
    number = segment_at(cam.drive.plan, angle % math.tau)
    start, end = angles_of(cam.drive.plan, number)
    return number, (angle % math.tau - start) / (end - start)


def _angle(cam: Cam, place: Place) -> float:
    start, end = angles_of(cam.drive.plan, place[0])
    return start + place[1] * (end - start)
