"""Effect `shock-spectrum`: what remains of the vibration after each move, over t_move / T_n.

The train is at rest when the move begins; after it the free vibration has an amplitude that is told
as a share of the stroke, see `camgeo.numeric.oscillator.spectrum`. Two figures are taken from the
spectrum: the largest share from one natural period a move upwards, and the ratio from which on it
stays below 1 %. Trains with less than one period a move hardly follow: what remains tends to the
stroke itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Request, Result
from camgeo.effects.shock_spectrum import Spec
from camgeo.effects.shock_spectrum.moves import RestToRest, moves_of
from camgeo.motion.motion import Side
from camgeo.motion.time_course import ConstantSpeed
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, grid_of, piecewise_extremes
from camgeo.numeric.oscillator.spectrum import Shock
from camgeo.numeric.roots import bracketed_roots

QUIET: Final = 0.01
"""Share of the stroke below which a residual vibration counts as small."""

SMALLEST_RATIO: Final = 1e-12
"""Stands for 0, where what remains is what the move has gone."""

FIRST_SPAN: Final = 10.0
"""Ratios searched at first, in one go; further ones only while something there may count."""

LONGEST: Final = 1000.0
"""Ratio up to which it is looked for where the residual gets small for good; a jump of the velocity
as large as the mean one leaves 1 % at a ratio of 32."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """The spectrum of one move.

    Attributes
    ----------
    move : with its place.
    damping : damping ratio of the train.
    worst : the largest residual from ratio 1 on, or over all of them if they end below, with its
        ratio; where it is taken first.
    quiet : ratio from which on the residual stays below a hundredth; None if it does not up to the
        highest one, 0 if it always is.
    """

    move: RestToRest
    damping: float
    worst: Extreme
    quiet: float | None

    def residual(self, ratios: FloatArray) -> FloatArray:
        """(n,) amplitude by stroke at the ratios (n,) of the move's duration to T_n, above 0."""
        return self.move.shock.residual(ratios, self.damping)


@dataclass(frozen=True, slots=True, eq=False)
class ShockSpectrum(Result):
    """What `compute` gives.

    Attributes
    ----------
    spectra : of the moves from rest to rest, in the order of the cam angle.
    highest_ratio : up to which they were looked at.
    """

    spectra: tuple[Spectrum, ...]
    highest_ratio: float


def compute(request: Request[Spec]) -> ShockSpectrum:
    """The spectra of all moves.

    Without a speed of the cam it is taken to turn evenly; how fast does not matter.
    A plan without a move from rest to rest has none, which is a warning.
    """
    spec, subject = request.spec, request.subject
    course = subject.drive.time_course or ConstantSpeed(1.0)
    moves = moves_of(subject, course)
    if not moves:
        sentence = (
            "no move is from rest to rest, with velocity and acceleration 0 at both ends: there is"
            " no residual vibration to speak of"
        )
        none = Finding("shock-spectrum", "warning", sentence)
        return ShockSpectrum((), spec.highest_ratio, findings=(none,))
    spectra = tuple(
        Spectrum(move, spec.damping, *measured(move.shock, spec.damping, spec.highest_ratio))
        for move in moves
    )
    findings = [each for found in spectra for each in _findings(found, spec.highest_ratio)]
    return ShockSpectrum(spectra, spec.highest_ratio, findings=tuple(findings))


def _findings(found: Spectrum, highest: float) -> Iterator[Finding]:
    start = found.move.start
    ends = math.degrees(start), math.degrees(start + found.move.span)
    move = f"the move from cam angle {ends[0]:.6g} to {ends[1]:.6g} deg"
    yield Finding(
        name="largest-residual",
        severity="ok",
        sentence=(
            f"after {move} {100.0 * found.worst.value:.4g} % of the stroke remain as vibration at"
            f" most, with {found.worst.place:.4g} natural periods a move; looked at"
            f" {'from 1 up' if highest > 1.0 else 'up'} to {highest:g}"
        ),
        value=found.worst.value,
        cam_angle=start,
    )
    below = (
        f"does not stay below {100.0 * QUIET:g} % of the stroke up to {highest:g} natural periods"
        if found.quiet is None
        else f"stays below {100.0 * QUIET:g} % of the stroke from {found.quiet:.4g} natural periods"
        " a move on"
    )
    yield Finding(
        name="residual-small-from",
        severity="ok",
        sentence=f"what remains after {move} {below}",
        value=found.quiet,
        cam_angle=start,
    )


def measured(move: Shock, damping: float, end: float) -> tuple[Extreme, float | None]:
    """Two figures of the spectrum of `move` up to the ratio `end`.

    The largest residual from ratio 1 on, or over all of them if `end` is no higher, with its ratio;
    and the ratio from which on it stays below `QUIET` for good: None if there is none up to `end`,
    0 if it always does.
    Only as much of the spectrum is looked at as its bound leaves open.
    """
    low = 1.0 if end > 1.0 else 0.0

    def residual(ratios: FloatArray) -> FloatArray:
        return move.residual(ratios, damping)

    def sided(ratios: FloatArray, _: Side) -> FloatArray:
        return residual(np.maximum(ratios, SMALLEST_RATIO))

    high = min(end, FIRST_SPAN)
    worst = piecewise_extremes(sided, _unit_edges(low, high)).highest
    while high < end and move.bound(high, damping) > worst.value:
        low, high = high, min(end, 2.0 * high)
        further = piecewise_extremes(sided, _unit_edges(low, high)).highest
        worst = max(worst, further, key=lambda each: each.value)
    # Beyond this ratio the bound says it; `end` itself may be a zero with more behind it.
    reach = FIRST_SPAN
    while move.bound(reach, damping) > QUIET:
        if reach > max(end, LONGEST):
            return worst, None
        reach *= 2.0
    grid = np.append(grid_of(_unit_edges(SMALLEST_RATIO, reach)).ravel(), reach)
    loud = np.flatnonzero(residual(grid) > QUIET)
    if not len(loud):
        return worst, 0.0
    last = int(loud[-1])
    if grid[last] >= end:
        return worst, None
    root = bracketed_roots(
        lambda ratios: residual(ratios) - QUIET, grid[last : last + 1], grid[last + 1 : last + 2]
    )
    return worst, float(root[0]) if root[0] <= end else None


def _unit_edges(low: float, high: float) -> FloatArray:
    """Edges one ratio apart at most: the residual turns no faster than cos(2 pi ratio)."""
    return np.linspace(low, high, max(2, math.ceil(high - low) + 1))
