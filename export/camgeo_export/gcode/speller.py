"""Moves written as blocks of a program.

Coordinates are whole multiples of the last printed decimal from the start, so that what is
checked here is what the controller reads.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field

from camgeo.errors import GeometryError, ToleranceError
from camgeo.reading import PROGRAM_LINES
from camgeo.toolpath.machine_tables import ArcLimits, NumberForm
from camgeo.toolpath.machining_time import arc_sweep
from camgeo.toolpath.moves import ArcFeed, Feed, Point, Rapid, too_long
from camgeo.toolpath.turning import OTHER
from camgeo.toolpath.zero import OF_THE_PART, Zero
from camgeo_export.gcode.blocks import Budget, Grid, number
from camgeo_export.gcode.dialects import Dialect

Steps = tuple[int, int, int]


@dataclass(slots=True)
class Speller:
    """Writes moves one after another; tracks the cutter position, exact and as printed.

    Moves are in the part's coordinates; where the work is turned over, what is printed is their
    mirror image.

    Attributes
    ----------
    grid : of the printed numbers.
    budget : of the deviation.
    limits : of the machine's arcs.
    dialect : of the blocks.
    numbers : the form of numbers on the machine.
    zero : of the program's coordinates.
    blocks : written since they were last taken.
    arcs, lines : cutting blocks written so far.
    switches : words of the controller's compensation, by what they switch it to on the machine.
    reach : largest magnitude of a coordinate so far, in steps of the grid.
    """

    grid: Grid
    budget: Budget
    limits: ArcLimits
    dialect: Dialect
    numbers: NumberForm
    zero: Zero = OF_THE_PART
    blocks: list[str] = field(default_factory=list)
    switches: dict[str, str] = field(default_factory=dict)
    arcs: int = 0
    lines: int = 0
    reach: int = 0
    _exact: complex = 0j
    _exact_z: float = math.nan
    _at: tuple[int | None, int | None, int | None] = (None, None, None)
    _feed: str = ""

    @property
    def place(self) -> complex:
        """The cutter's exact place in the plane [mm]."""
        return self._exact

    def take(self) -> list[str]:
        """The blocks written since the last call."""
        blocks, self.blocks = self.blocks, []
        return blocks

    def forget(self) -> None:
        """A block of the program's own has moved the cutter along Z, nobody knows where to."""
        self._at = (*self._at[:2], None)

    def restart(self) -> None:
        """State place and feed again in the next blocks, as a program may be started here."""
        self._at = (None, None, self._at[2])
        self._feed = ""

    def at_height(self, height: float) -> bool:
        """Whether the cutter is at Z `height` [mm], as printed."""
        return self._at[2] == self._level(height)

    def height(self, height: float) -> str:
        """Z `height` [mm] as printed."""
        return self.grid.text(self._level(height), signed=self.dialect.signed)

    def _level(self, height: float) -> int:
        return self.grid.steps(height - self.zero.z)

    def reached(self, height: float) -> None:
        """A block of the program's own has moved the cutter to Z `height` [mm]."""
        self._at = (*self._at[:2], self._level(height))
        self._exact_z = height

    def retract(self, height: float) -> None:
        """Traverse to Z `height` [mm], from any cutter position."""
        self.blocks.append(self.dialect.rapid([("Z", self.height(height))]))
        self.reached(height)

    def across(self, end: Point) -> None:
        """Traverse to X and Y of `end` at the cutter's height, whatever it is."""
        x, y, _ = self._steps(end)
        self.blocks.append(self.dialect.rapid(self._texts((("X", x), ("Y", y)))))
        self._at = (x, y, self._at[2])
        self._exact = complex(end[0], end[1])

    def move(self, move: Rapid | Feed | ArcFeed) -> None:
        """Write one move; FileError if the program becomes too long to be read."""
        if isinstance(move, Rapid):
            self._traverse(self._steps(move.end))
        elif isinstance(move, Feed):
            side = OTHER[move.switch] if self.zero.turned else move.switch
            switch = self.switches.get(side, "")
            self._straight(self._steps(move.end), self._feed_text(move.feed), switch)
        else:
            self._arc(move)
        self._exact, self._exact_z = complex(move.end[0], move.end[1]), move.end[2]

    def _steps(self, end: Point) -> Steps:
        x, y, z = self.zero.of_point(end)
        steps = self.grid.steps(x), self.grid.steps(y), self.grid.steps(z)
        self.reach = max(self.reach, *map(abs, steps))
        return steps

    def _texts(self, values: tuple[tuple[str, int], ...]) -> list[tuple[str, str]]:
        signed = self.dialect.signed
        return [(axis, self.grid.text(value, signed=signed)) for axis, value in values]

    def _traverse(self, end: Steps) -> None:
        if end[2] != self._at[2] and (end[0], end[1]) != self._at[:2]:
            raise ValueError("a traverse must move either in Z or in the plane")
        if changes := self._changes(end):
            self.blocks.append(self.dialect.rapid(changes))
        self._at = end

    def _straight(self, end: Steps, feed: str, switch: str = "") -> None:
        if changes := self._changes(end):
            self.blocks.append(self.dialect.line(changes, self._new(feed), switch))
            self.lines += 1
            if self.lines > PROGRAM_LINES:
                raise too_long()
        self._at = end

    def _changes(self, end: Steps) -> list[tuple[str, str]]:
        """The coordinates that change, X and Y together; none if the block moves nothing."""
        plane = (end[0], end[1]) != self._at[:2]
        values: tuple[tuple[str, int], ...] = (("X", end[0]), ("Y", end[1])) if plane else ()
        return self._texts(values + ((("Z", end[2]),) if end[2] != self._at[2] else ()))

    def _arc(self, move: ArcFeed) -> None:
        centre = complex(*move.centre)
        end = complex(move.end[0], move.end[1])
        arm = self._exact - centre
        radius = abs(arm)
        sweep = arc_sweep(arm, end - centre, ccw=move.ccw)
        feed = self._feed_text(move.feed)
        helix = self._steps(move.end)[2] != self._at[2]
        chords = not self.budget.arcs or _sagitta(radius, sweep) <= self.budget.chord
        chords = chords or (helix and not self.limits.helical)
        if chords or not self.limits.smallest_radius <= radius <= self.limits.largest_radius:
            low, high = self._exact_z, move.end[2]
            for part in _chord_ends(radius, sweep, self.budget.chord):
                point = centre + arm * cmath.exp(1j * sweep * part) if part < 1.0 else end
                z = low + (high - low) * part if part < 1.0 else high
                self._straight(self._steps((point.real, point.imag, z)), feed)
            return
        ccw = move.ccw != bool(self.zero.turned)
        self._printed_arc(self._steps(move.end), self.zero.of(centre), feed, ccw=ccw)

    def _printed_arc(self, end: Steps, centre: complex, feed: str, *, ccw: bool) -> None:
        """An arc block between printed points, with a centre recomputed for them and checked."""
        x, y, z = self._at
        if x is None or y is None or z is None:
            raise ValueError("an arc must start at a known point")
        if (end[0], end[1]) == (x, y):
            # A controller takes equal end points for a full circle.
            self._straight(end, feed)
            return
        start = complex(self.grid.mm(x), self.grid.mm(y))
        target = complex(self.grid.mm(end[0]), self.grid.mm(end[1]))
        chord = target - start
        # Onto the bisector: the radii at both ends then differ by the rounding of I and J only.
        height = ((centre - start) / chord).imag
        offset = chord * complex(0.5, height)
        if self.limits.centre == "incremental":
            i, j = self.grid.steps(offset.real), self.grid.steps(offset.imag)
            printed = complex(self.grid.mm(i), self.grid.mm(j))
        else:
            i, j = self.grid.steps((start + offset).real), self.grid.steps((start + offset).imag)
            printed = complex(self.grid.mm(i), self.grid.mm(j)) - start
        mismatch = abs(abs(printed) - abs(target - start - printed))
        allowed = min(self.limits.radius_tolerance, self.budget.rounding)
        if mismatch > allowed:
            text = f"radii of the arc to X{self.grid.text(end[0])} Y{self.grid.text(end[1])} differ"
            raise ToleranceError(text, allowed, mismatch)
        ends = (("X", end[0]), ("Y", end[1]), *((("Z", end[2]),) if end[2] != z else ()))
        middle = self._texts((("X", i), ("Y", j)))
        self.blocks += self.dialect.arc(self._texts(ends), middle, self._new(feed), ccw=ccw)
        self.arcs += 1
        self._at = end

    def _feed_text(self, feed: float) -> str:
        """The feed [mm/min] in program units."""
        inches = self.grid.mm_per_unit != 1.0
        scale = self.grid.mm_per_unit * (self.numbers.inch_feed if inches else 1.0)
        text = number(feed / scale, self.numbers.feed_decimals)
        if float(text) <= 0.0:
            places = self.numbers.feed_decimals
            message = f"a feed of {feed:.3g} mm/min is 0 in the {places} decimals of the program"
            raise GeometryError(message, "tool.feed", f"{feed:.3g}")
        pointed = self.numbers.point == "required" or self.numbers.feed_increment is not None
        return f"{text}." if pointed and "." not in text else text

    def _new(self, feed: str) -> str:
        """The feed if it changes; else nothing."""
        if feed == self._feed:
            return ""
        self._feed = feed
        return feed


def _sagitta(radius: float, sweep: float) -> float:
    return 2.0 * radius * math.sin(0.25 * sweep) ** 2


def _chord_ends(radius: float, sweep: float, sagitta: float) -> list[float]:
    """Ends of the fewest equal chords within `sagitta` of the arc, as fractions of it up to 1."""
    ratio = math.sqrt(min(1.0, 0.5 * sagitta / radius))
    count = max(1, math.ceil(abs(sweep) / (4.0 * math.asin(ratio)) - 1e-9))
    return [(index + 1) / count for index in range(count)]
