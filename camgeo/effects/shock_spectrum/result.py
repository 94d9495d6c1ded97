"""Effect `shock-spectrum`: the residual vibration after each move, over t_move / T_n.

The train is at rest when the move begins. The amplitude of its free vibration after the move is
given relative to the stroke, see `camgeo.numeric.oscillator.spectrum`. Two values are taken from
the spectrum: the largest residual from one natural period per move upwards, and the ratio above
which it stays below 1 %. With less than one period per move the train hardly follows, and the
residual approaches the stroke itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Request, Result
from camgeo.effects.shock_spectrum import SpectrumRange
from camgeo.effects.shock_spectrum.moves import RestToRest, moves_of
from camgeo.motion.time_course import ConstantSpeed
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, grid_of, piecewise_highest
from camgeo.numeric.oscillator.spectrum import QUIET, Shock
from camgeo.numeric.roots import bracketed_roots

SMALLEST_RATIO: Final = 1e-12
"""Stands for 0, where the residual equals the final position of the move."""

FIRST_SPAN: Final = 10.0
"""Ratios searched first, in one step; further ones only while they may have the maximum."""

LONGEST: Final = 1000.0
"""Ratio up to which the start of the permanently small residual is searched for; a velocity jump as
large as the mean velocity leaves 1 % at a ratio of 32."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """The spectrum of one move.

    Attributes
    ----------
    move : with its place.
    damping : damping ratio of the train.
    worst : the largest residual above ratio 1, or above 0 if the range ends below 1, with the
        first ratio at which it occurs.
    quiet : ratio above which the residual stays below 1 %; None if it does not up to the highest
        ratio, 0 if it always does.
    """

    move: RestToRest
    damping: float
    worst: Extreme
    quiet: float | None

    def residual(self, ratios: FloatArray) -> FloatArray:
        """(n,) amplitude relative to the stroke at `ratios` (n,), above 0, of duration to T_n."""
        return self.move.shock.residual(ratios, self.damping)

    def largest(self, ratios: FloatArray) -> FloatArray:
        """(n,) largest deflection likewise, see `Shock.largest`."""
        return self.move.shock.largest(ratios, self.damping)


@dataclass(frozen=True, slots=True, eq=False)
class ShockSpectrum(Result):
    """The shock spectra of a motion.

    Attributes
    ----------
    spectra : of the moves from rest to rest, in the order of the cam angle.
    highest_ratio : their upper end.
    """

    spectra: tuple[Spectrum, ...]
    highest_ratio: float


def compute(request: Request[SpectrumRange]) -> ShockSpectrum:
    """The spectra of all moves.

    Without a speed the cam is assumed to turn at constant speed; its value does not matter. A plan
    without a move from rest to rest has no spectrum, which is a warning.
    """
    data, subject = request.data, request.subject
    course = subject.state.course or ConstantSpeed(1.0)
    moves = moves_of(subject, course)
    if not moves:
        sentence = (
            "no move is from rest to rest, with velocity and acceleration 0 at both ends, so there"
            " is no residual vibration"
        )
        none = Finding("shock-spectrum", "warning", sentence)
        return ShockSpectrum((), data.highest_ratio, findings=(none,))
    spectra = tuple(_spectra(moves, data))
    findings = [each for found in spectra for each in _findings(found, data.highest_ratio)]
    return ShockSpectrum(spectra, data.highest_ratio, findings=tuple(findings))


def _spectra(moves: list[RestToRest], data: SpectrumRange) -> Iterator[Spectrum]:
    """The spectrum of each move; moves of one law have that of the longest, the best resolved."""

    def kind(move: RestToRest) -> int:
        return id(move if move.law is None else move.law)

    longest = {kind(move): move for move in sorted(moves, key=lambda each: each.span)}
    known = {
        each: measured(move.shock, data.damping, data.highest_ratio)
        for each, move in longest.items()
    }
    for move in moves:
        yield Spectrum(move, data.damping, *known[kind(move)])


def _findings(found: Spectrum, highest: float) -> Iterator[Finding]:
    start = found.move.start
    ends = math.degrees(start), math.degrees(start + found.move.span)
    move = f"the move from cam angle {ends[0]:.6g} to {ends[1]:.6g} deg"
    yield Finding(
        name="largest-residual",
        severity="ok",
        sentence=(
            f"after {move} at most {100.0 * found.worst.value:.4g} % of the stroke remains as"
            f" vibration, with {_periods(f'{found.worst.place:.4g}')} per move; range searched"
            f" {'1' if highest > 1.0 else '0'} to {highest:g}"
        ),
        value=found.worst.value,
        cam_angle=start,
    )
    small = f"{100.0 * QUIET:g} % of the stroke"
    below = (
        f"does not stay below {small} up to {_periods(f'{highest:g}')} per move"
        if found.quiet is None
        else f"stays below {small} above {_periods(f'{found.quiet:.4g}')} per move"
    )
    yield Finding(
        name="residual-small-from",
        severity="ok",
        sentence=f"the vibration after {move} {below}",
        value=found.quiet,
        cam_angle=start,
    )


def _periods(number: str) -> str:
    return f"{number} natural period{'' if number == '1' else 's'}"


def measured(move: Shock, damping: float, end: float) -> tuple[Extreme, float | None]:
    """Two values of the spectrum of `move` up to the ratio `end`.

    The largest residual above ratio 1, or above 0 if `end` is at most 1, with its ratio; and the
    ratio above which it stays below `QUIET`: None if there is none up to `end`, 0 if it always
    does. The spectrum is evaluated only where its bound leaves the answer open.
    """
    low = 1.0 if end > 1.0 else 0.0

    def residual(ratios: FloatArray) -> FloatArray:
        return move.residual(ratios, damping)

    def sided(ratios: FloatArray, _: Side) -> FloatArray:
        return residual(np.maximum(ratios, SMALLEST_RATIO))

    high = min(end, FIRST_SPAN)
    worst = piecewise_highest(sided, _unit_edges(low, high))
    while high < end and move.bound(high, damping) > worst.value:
        low, high = high, min(end, 2.0 * high)
        further = piecewise_highest(sided, _unit_edges(low, high))
        worst = max(worst, further, key=lambda each: each.value)
    # Beyond this ratio the bound proves it; `end` may be a zero with more residual behind it.
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
    """Edges at most 1 apart: the residual varies no faster than cos(2 pi ratio)."""
    return np.linspace(low, high, max(2, math.ceil(high - low) + 1))
