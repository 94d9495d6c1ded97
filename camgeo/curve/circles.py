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

NOWHERE = complex(np.nan, np.nan)


@singledispatch
def harmonics(_motion: Motion) -> tuple[Dwell, ...]:
    """The stretches on which it is known that s''' = -s', apart from rests; no border inside."""
    return ()


@harmonics.register
def _of_plan(motion: MotionPlan) -> tuple[Dwell, ...]:
    return motion.harmonics


@dataclass(frozen=True, slots=True, eq=False)
class Circles:
    """The stretches of a pitch curve that are known to be arcs, in order.

    Attributes
    ----------
    starts, spans : (k,) [rad] cam angles at which they begin, in [0, 2 pi), and their lengths.
    centres : (k,) complex [mm] the point about which each turns rigidly with the cam.
    """

    starts: FloatArray
    spans: FloatArray
    centres: ComplexArray


@kept_with_owner
def circles(pitch: PitchCurve) -> Circles:
    """All stretches known to be arcs."""
    rests = pitch.dwells
    moves = harmonics(pitch.motion) if pitch.follower.harmonic_is_round else ()
    starts = np.array([each.start for each in (*rests, *moves)])
    spans = np.array([each.span for each in (*rests, *moves)])
    centres = np.zeros(len(starts), dtype=np.complex128)
    if moves:
        moving = slice(len(rests), None)
        jet = pitch.jet(starts[moving] + 0.5 * spans[moving])
        centres[moving] = jet[0] - 1j * pitch.rotation * jet[1]
    order = np.argsort(starts)
    return Circles(starts[order], spans[order], centres[order])


def centres_at(pitch: PitchCurve, phi: FloatArray) -> ComplexArray:
    """(n,) complex [mm] the point about which the curve turns rigidly with the cam at `phi` (n,)
    [rad], places between borders; NaN where it is not known to.
    """
    known = circles(pitch)
    if not len(known.starts):
        return np.full(len(phi), NOWHERE)
    last = np.searchsorted(known.starts, phi % TURN, side="right") - 1  # before the first: the last
    # Both ends are borders: a place between them is not affected by rounding.
    inside = (phi - known.starts[last]) % TURN < known.spans[last]
    return np.where(inside, known.centres[last], NOWHERE)


@kept_with_owner
def arc_pieces(curve: WorkingCurve) -> tuple[Piece, ...]:
    """As `smooth_pieces`, with the centres of those that are arcs; neighbours on one circle are one
    piece.
    """
    pitch, smooth = curve.pitch, smooth_pieces(curve)
    farthest = float(np.max(np.abs(circles(pitch).centres), initial=0.0))
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
