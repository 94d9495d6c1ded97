"""Moves written as blocks of a program.

Coordinates are whole multiples of the last printed decimal from the start, so that what is
checked here is what the controller reads.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field

from camgeo.errors import ToleranceError
from camgeo.reading import PROGRAM_LINES
from camgeo.toolpath.machine import Machine
from camgeo.toolpath.machine_tables import ArcLimits
from camgeo.toolpath.machining_time import arc_sweep
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Rapid
from camgeo.toolpath.plan import too_long
from camgeo.units import MM_PER, LengthUnit

FEED_DECIMALS = 4
"""Decimals of a feed, trailing zeros dropped."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Printed coordinates: whole multiples of the last decimal.

    Attributes
    ----------
    decimals : printed.
    mm_per_unit : of the program's unit of length.
    """

    decimals: int
    mm_per_unit: float

    @property
    def _scale(self) -> int:
        scale: int = 10**self.decimals
        return scale

    def steps(self, length: float) -> int:
        """`length` [mm] in units of the last decimal, rounded."""
        return round(length / self.mm_per_unit * self._scale)

    def mm(self, steps: int) -> float:
        """What a reader makes of the printed number [mm]."""
        return steps / self._scale * self.mm_per_unit

    def text(self, steps: int) -> str:
        """The printed number; zero has no sign."""
        whole, part = divmod(abs(steps), self._scale)
        sign = "-" if steps < 0 else ""
        return f"{sign}{whole}.{part:0{self.decimals}d}"


def number(value: float) -> str:
    """A feed or a speed with as many digits as it has."""
    return f"{value:.{FEED_DECIMALS}f}".rstrip("0").rstrip(".")


@dataclass(slots=True)
class Speller:
    """Writes moves one after another; tracks the cutter position, exact and as printed.

    Attributes
    ----------
    grid : of the printed numbers.
    budget : of the deviation.
    limits : of the machine's arcs.
    blocks : written since they were last taken.
    arcs, lines : cutting blocks written so far.
    """

    grid: Grid
    budget: Budget
    limits: ArcLimits
    blocks: list[str] = field(default_factory=list)
    arcs: int = 0
    lines: int = 0
    _exact: complex = 0j
    _at: tuple[int | None, int | None, int | None] = (None, None, None)
    _feed: str = ""

    def take(self) -> list[str]:
        """The blocks written since the last call."""
        blocks, self.blocks = self.blocks, []
        return blocks

    def retract(self, height: float) -> None:
        """Traverse to Z `height` [mm], from any cutter position."""
        z = self.grid.steps(height)
        self._write("G0 Z" + self.grid.text(z), "")
        self._at = (self._at[0], self._at[1], z)

    def move(self, move: Move) -> None:
        """Write one move; FileError if the program becomes too long to be read."""
        end = complex(move.end[0], move.end[1])
        if isinstance(move, Rapid):
            self._straight("G0", self._steps(move.end), "")
        elif isinstance(move, Feed):
            self._straight("G1", self._steps(move.end), self._feed_word(move.feed))
        else:
            self._arc(move, end)
        self._exact = end

    def _steps(self, end: tuple[float, float, float]) -> tuple[int, int, int]:
        return self.grid.steps(end[0]), self.grid.steps(end[1]), self.grid.steps(end[2])

    def _straight(self, word: str, end: tuple[int, int, int], feed: str) -> None:
        """A straight block with the coordinates that change; no block if none changes."""
        axes = "XYZ"
        if (end[0], end[1]) == self._at[:2]:
            axes = "Z"
        elif end[2] == self._at[2]:
            axes = "XY"
        words = [
            axis + self.grid.text(value)
            for axis, value, before in zip("XYZ", end, self._at, strict=True)
            if axis in axes and not (axes == "Z" and value == before)
        ]
        if words:
            self._write(" ".join((word, *words)), feed)
            self.lines += word == "G1"
            if self.lines > PROGRAM_LINES:
                raise too_long()
        self._at = end

    def _arc(self, move: ArcFeed, end: complex) -> None:
        centre = complex(*move.centre)
        arm = self._exact - centre
        radius = abs(arm)
        sweep = arc_sweep(arm, end - centre, ccw=move.ccw)
        feed = self._feed_word(move.feed)
        straight = _sagitta(radius, sweep) <= self.budget.chord
        if straight or not self.limits.smallest_radius <= radius <= self.limits.largest_radius:
            for part in _chord_ends(radius, sweep, self.budget.chord):
                point = centre + arm * cmath.exp(1j * sweep * part) if part < 1.0 else end
                self._straight("G1", self._steps((point.real, point.imag, move.end[2])), feed)
            return
        self._printed_arc(self._steps(move.end), centre, move.ccw, feed)

    def _printed_arc(
        self, end: tuple[int, int, int], centre: complex, ccw: bool, feed: str
    ) -> None:
        """An arc block between printed points, with a centre recomputed for them and checked."""
        x, y = self._at[0], self._at[1]
        if x is None or y is None or end[2] != self._at[2]:
            raise ValueError("an arc must start at a known point and stay in its plane")
        if (end[0], end[1]) == (x, y):
            # A controller takes equal end points for a full circle.
            return
        start = complex(self.grid.mm(x), self.grid.mm(y))
        target = complex(self.grid.mm(end[0]), self.grid.mm(end[1]))
        chord = target - start
        # Onto the bisector: the radii at both ends then differ by the rounding of I and J only.
        height = ((centre - start) / chord).imag
        offset = chord * complex(0.5, height)
        i, j = self.grid.steps(offset.real), self.grid.steps(offset.imag)
        printed = complex(self.grid.mm(i), self.grid.mm(j))
        mismatch = abs(abs(printed) - abs(target - start - printed))
        allowed = min(self.limits.radius_tolerance, self.budget.rounding)
        if mismatch > allowed:
            text = f"radii of the arc to X{self.grid.text(end[0])} Y{self.grid.text(end[1])} differ"
            raise ToleranceError(text, allowed, mismatch)
        words = (
            "G3" if ccw else "G2",
            "X" + self.grid.text(end[0]),
            "Y" + self.grid.text(end[1]),
            "I" + self.grid.text(i),
            "J" + self.grid.text(j),
        )
        self._write(" ".join(words), feed)
        self.arcs += 1
        self._at = end

    def _feed_word(self, feed: float) -> str:
        """F with the feed [mm/min] in program units."""
        text = number(feed / self.grid.mm_per_unit)
        if float(text) <= 0.0:
            raise ValueError(f"a feed of {feed} mm/min cannot be written")
        return " F" + text

    def _write(self, block: str, feed: str) -> None:
        if feed and feed != self._feed:
            self._feed = feed
            block += feed
        self.blocks.append(block)


def _sagitta(radius: float, sweep: float) -> float:
    return 2.0 * radius * math.sin(0.25 * sweep) ** 2


def _chord_ends(radius: float, sweep: float, sagitta: float) -> list[float]:
    """Ends of the fewest equal chords within `sagitta` of the arc, as fractions of it up to 1."""
    ratio = math.sqrt(min(1.0, 0.5 * sagitta / radius))
    count = max(1, math.ceil(abs(sweep) / (4.0 * math.asin(ratio)) - 1e-9))
    return [(index + 1) / count for index in range(count)]


ROUNDING_SHARE = 0.3
"""Share of the tolerance for printed numbers; it decides the number of decimals: four at 1 um."""

ROUNDING_UNITS = 3.0
"""Deviation by rounding, in units of the last decimal: end points and centre each move by at most
half a diagonal, 0.71, and the radii at an arc's two ends then differ by at most 1.42."""

CHORD_SHARE = 0.05
"""Share of the tolerance for arcs that are written as chords: nearly straight ones, and those whose
radius the machine does not accept."""

PROOF_SHARE = 0.05
"""Share of the tolerance left for the slack of the bound by which the program is measured."""


@dataclass(frozen=True, slots=True)
class Budget:
    """Shares of the tolerance; all lengths in mm.

    Attributes
    ----------
    tolerance : the whole.
    decimals : of the printed coordinates, in the program's unit.
    rounding : largest deviation by printing with these decimals.
    chord : largest sagitta of an arc written as chords.
    blending : the P of path blending, 0 for the exact path.
    fit : what is left for the cutter path's lines and arcs.
    interpolation : how far the controller's own path departs from an arc.
    """

    tolerance: float
    decimals: int
    rounding: float
    chord: float
    blending: float
    fit: float
    interpolation: float = 0.0


def budget(machine: Machine, unit: LengthUnit, tolerance: float) -> Budget:
    """The shares of `tolerance` [mm] on `machine`."""
    finest = ROUNDING_SHARE * tolerance / (ROUNDING_UNITS * MM_PER[unit])
    decimals = max(machine.numbers.decimals.of(unit), math.ceil(-math.log10(finest)))
    most = machine.numbers.most_decimals.of(unit)
    if decimals > most:
        least = ROUNDING_UNITS * MM_PER[unit] / 10.0**most / ROUNDING_SHARE
        message = f"{most} decimals in a program are too coarse"
        raise ToleranceError(message, tolerance, least)
    step = 10.0**-decimals
    rounding = ROUNDING_UNITS * step * MM_PER[unit]
    chord = CHORD_SHARE * tolerance
    smoothing = machine.smoothing
    blending = 0.0 if smoothing is None else min(smoothing.share * tolerance, smoothing.largest)
    if smoothing is None or blending < smoothing.smallest * (1.0 - 1e-9):
        blending = 0.0
    # rounded down to what is printed
    blending = math.floor(blending / MM_PER[unit] / step + 1e-9) * step * MM_PER[unit]
    interpolation = machine.arcs.interpolation
    fit = tolerance * (1.0 - PROOF_SHARE) - rounding - chord - blending - interpolation
    if fit <= 0.0:
        raise ToleranceError(
            "nothing of the tolerance is left for the fit", tolerance, tolerance - fit
        )
    return Budget(tolerance, decimals, rounding, chord, blending, fit, interpolation)
