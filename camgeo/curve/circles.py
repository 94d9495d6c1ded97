"""The stretches of a pitch curve that are exactly arcs, run through evenly as the cam turns.

Rests are arcs about the cam axis. Under a flat face on a guide so is each stretch with s''' = -s',
about a point of the cam: an eccentric disc. Z turns rigidly about it, Z' = -i sigma (Z - c), and so
do all parallels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from camgeo.curve.pieces import Piece, smooth_pieces
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.motion.kept import kept_with_owner
from camgeo.motion.motion import Dwell, Motion
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a centre, as a fraction of the lengths that it is computed from."""


@singledispatch
def harmonics(_motion: Motion) -> tuple[Dwell, ...]:
    """The stretches on which it is known that s''' = -s', apart from rests; no border inside."""
    return ()


@harmonics.register
def _of_plan(motion: MotionPlan) -> tuple[Dwell, ...]:
    return motion.harmonics


@dataclass(frozen=True, slots=True)
class Circle:
    """A stretch of `span` [rad] from the cam angle `start` [rad] that turns about `centre` [mm]."""

    start: float
    span: float
    centre: complex


@kept_with_owner
def circles(pitch: PitchCurve) -> tuple[Circle, ...]:
    """All stretches known to be arcs."""
    spans, centres = [*pitch.dwells], [0j] * len(pitch.dwells)
    harmonic = harmonics(pitch.motion) if pitch.follower.harmonic_is_round else ()
    if harmonic:
        jet = pitch.jet(np.array([each.start + 0.5 * each.span for each in harmonic]))
        spans += harmonic
        centres += (jet[0] - 1j * pitch.rotation * jet[1]).tolist()
    return tuple(Circle(each.start, each.span, c) for each, c in zip(spans, centres, strict=True))


def centres_at(pitch: PitchCurve, phi: FloatArray) -> ComplexArray:
    """(n,) complex [mm] the point about which the curve turns rigidly with the cam at `phi` (n,)
    [rad], places between borders; NaN where it is not known to.
    """
    centres = np.full(len(phi), complex(np.nan, np.nan))
    for circle in circles(pitch):
        # Both ends are borders: a place between them is not affected by rounding.
        centres[(phi - circle.start) % TURN < circle.span] = circle.centre
    return centres


@kept_with_owner
def arc_pieces(curve: WorkingCurve) -> tuple[Piece, ...]:
    """As `smooth_pieces`, with the centres of those that are arcs; neighbours on one circle are one
    piece.
    """
    pitch, smooth = curve.pitch, smooth_pieces(curve)
    farthest = max((abs(circle.centre) for circle in circles(pitch)), default=0.0)
    if farthest == 0.0:  # rests alone
        return smooth
    near = ROUNDING * (farthest + pitch.follower.base_radius)
    borders = np.concatenate((pitch.borders, pitch.borders + TURN))
    found: list[Piece] = []
    for piece in smooth:
        inner = borders[(borders > piece.start) & (borders < piece.end)]
        ends = np.concatenate(([piece.start], inner, [piece.end]))
        about = centres_at(pitch, 0.5 * (ends[:-1] + ends[1:]))
        centre = complex(about[0]) if np.all(np.abs(about - about[0]) <= near) else None
        found.append(replace(piece, centre=centre))
        if _on_one_circle(found[-2:], near):
            found[-2:] = [replace(found[-2], end=piece.end)]
    if _on_one_circle([found[-1], found[0]], near):
        found[-1:] = [replace(found[-1], end=found.pop(0).end + TURN)]
    return tuple(found)


def _on_one_circle(pieces: list[Piece], near: float) -> bool:
    """Whether two neighbours have one centre, up to `near` [mm]."""
    one, other = pieces[0], pieces[-1]
    if one is other or one.centre is None or other.centre is None:
        return False
    return abs(one.centre - other.centre) <= near
