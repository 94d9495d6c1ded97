"""G-code: the milling program of the part in the words of a machine profile."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import zip_longest
from typing import Final, Protocol

from camgeo.check.finding import Finding
from camgeo.design.product import Product
from camgeo.design.writing import Written
from camgeo.errors import Fault, GeometryError, SceneError, ToleranceError
from camgeo.milling.compensation import KEY as KEY_OF_COMPENSATION
from camgeo.milling.compensation import Limit, limits_of, mode_of, programmed
from camgeo.milling.cut import Cut
from camgeo.milling.machine import KEY, ArcLimits, Machine, NumberForm, filled, load
from camgeo.milling.machining_time import toolpath_times
from camgeo.milling.milling import OTHER, WEAR, GcodeSpec, Tool
from camgeo.milling.moves import (
    ArcFeed,
    Feed,
    Operation,
    Point,
    Rapid,
    Stop,
    Toolpath,
    arc_sweep,
    too_long,
)
from camgeo.milling.zero import OF_THE_PART, Zero, box
from camgeo.numeric.checked import one_of
from camgeo.reading import PROGRAM_LINES
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.gcode.comments import (
    Budget,
    Grid,
    about_operation,
    about_program,
    budget,
    commented,
    number,
    side_sentence,
    spelled,
)
from camgeo_export.gcode.measure import measure

ENDINGS: Final = {"lf": "\n", "crlf": "\r\n"}


class GcodeWriter:
    """Writes a milling program."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The program, in the product's unit; path blending counts against `tolerance` [mm]."""
        spec = product.milled.gcode
        machine = load(spec.machine)
        setup = setup_of(product, spec, machine)
        shares = budget(machine, product.unit, tolerance)
        toolpath = product.milled.toolpath(shares.fit)
        watched = _safe(product, shares.fit, tolerance, toolpath)
        cuts = [operation.cut for operation in toolpath.operations]
        _check_tools(cuts, machine)
        about = about_program(product, machine, shares, cuts, product.scene_hash)
        program = written(toolpath, machine, shares, setup, about)
        lines = numbered(program.lines, machine)
        _check_length(lines, machine)
        _check_reach(program, machine)
        facts: dict[str, int | float | str] = {
            "operations": len(toolpath.operations),
            **({"side": side_sentence(product)} if side_sentence(product) else {}),
            "zero": setup.zero.sentence,
            "arcs": program.speller.arcs,
            "lines": program.speller.lines,
            "decimals": shares.decimals,
            "budget_fit_mm": _short(shares.fit),
            "budget_rounding_mm": _short(shares.rounding),
            "budget_chords_mm": _short(shares.chord),
            "path_blending_mm": _short(shares.blending),
        }
        if shares.interpolation > 0.0:
            facts["controller_arcs_mm"] = _short(shares.interpolation)
        if program.limits:
            facts["compensation"] = ", ".join(
                f"{each.operation} {each.mode} {each.most:.3f} mm"
                for each in program.limits.values()
            )
        if machine.dynamics is not None:
            smoothing = shares.blending if shares.blending > 0.0 else None
            times = toolpath_times(
                toolpath, machine.dynamics, chord=shares.interpolation, smoothing=smoothing
            )
            facts["machining_time_s"] = round(sum(each.seconds for each in times), 1)
            facts["machining_times"] = ", ".join(f"{t.name} {t.seconds:.1f} s" for t in times)
        ending = ENDINGS[machine.text.line_ending]
        return Written("".join(line + ending for line in lines).encode("ascii"), facts, watched)

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or one for each program where the machine cannot change tools."""
        return product.programs

    def measure(self, product: Product, data: bytes) -> float:
        """Run the program in our own interpreter and measure the cutter path [mm]."""
        return measure(product, data)


def _safe(
    product: Product, fit: float, tolerance: float, toolpath: Toolpath
) -> tuple[Finding, ...]:
    """What is to be watched in all programs, told with the first; raises UnsafeError like it."""
    whole = product.milled.whole
    if whole is None:
        return product.milled.safe(toolpath, tolerance)
    return () if product.program else whole.safe(whole.toolpath(fit), tolerance)


def setup_of(product: Product, spec: GcodeSpec, machine: Machine) -> Setup:
    """What the scene asks of the program; SceneError for what the machine does not have."""
    offset = spec.work_offset or next(iter(machine.work_offsets))
    allowed = {
        "coolant": machine.coolant.kinds,
        "work_offset": tuple(machine.work_offsets),
        "compensation": machine.compensations,
    }
    faults = []
    wanted = {("output.gcode.coolant", spec.coolant), ("output.gcode.work_offset", offset)}
    wanted |= {("tool.coolant", cut.tool.coolant or "off") for cut in product.milled.cuts}
    wanted |= {(KEY_OF_COMPENSATION, mode_of(cut)) for cut in product.milled.cuts}
    for key, value in sorted(wanted):
        try:
            one_of(key, value, allowed[key.rpartition(".")[2]])
        except GeometryError as error:
            message = f"{error.message} for {machine.name}"
            faults.append(Fault(error.key, repr(value), message))
    if faults:
        raise SceneError(faults)
    spin_up = machine.spindle.spin_up if spec.spin_up is None else spec.spin_up
    words = machine.work_offsets[offset]
    milled, away = product.milled, spec.tool_change_height
    before = 0 if milled.first is None else len(milled.first.programs)
    number = spec.program_number + product.position + 2 * (before + (product.program or 0))
    assert milled.spec is not None  # for there are cuts
    blank = box(milled.spec.stock, milled.part, milled.zero)
    return Setup(
        product.name, product.unit, words, spec.coolant, spin_up, number, away, milled.zero, blank
    )


def _short(length: float) -> float:
    """A share of the budget, to four digits."""
    return float(f"{length:.4g}")


def _check_tools(cuts: list[Cut], machine: Machine) -> None:
    tools = dict.fromkeys(cut.tool.number for cut in cuts)
    if len(tools) > 1 and not machine.tool_change.change:
        named = " and ".join(map(str, tools))
        message = f"a program cannot change tools there, but tools {named} are needed"
        allowed = "write one for each of them, or use a profile with tool_change.change"
        raise SceneError([Fault(KEY, repr(machine.name), f"{message}: {allowed}")])


def _check_length(lines: list[str], machine: Machine) -> None:
    for line in lines:
        if len(line) > machine.text.line_length:
            message = f"its text.line_length is too short for the block {line}"
            raise SceneError([Fault(KEY, repr(machine.name), message)])


def _check_reach(program: Program, machine: Machine) -> None:
    grid = program.speller.grid
    largest = grid.mm(program.speller.reach) / grid.mm_per_unit
    if largest > machine.numbers.largest:
        message = f"its numbers.largest is too small for the coordinate {largest:g}"
        raise SceneError([Fault(KEY, repr(machine.name), message)])


WRITER = GcodeWriter()


# -- frame ----------------------------------------------------------------------------------------
# A whole program: the moves of each operation within the blocks of a machine profile.
#
# Each operation states the modal state, the tool and its length, spindle and coolant, and
# approaches its first point from above, so that it can be restarted alone.


LONGEST_NAME: Final = 24
"""Characters of a program's name that controllers show."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What a scene asks of a program beyond its moves.

    Attributes
    ----------
    name : of the part.
    unit : of length.
    work_offset : words that select it.
    coolant : one of the machine's kinds, with tools that do not state theirs.
    spin_up : dwell behind the start of the spindle [s].
    number : of the program, on controllers that number them.
    away : Z at which tools are changed and the operator works [mm], where the machine's retract is
        a height; None for the clearance height.
    zero : of its coordinates.
    blank : the corners of the box around it, in its coordinates [mm]; None if they are not known.
    """

    name: str
    unit: LengthUnit
    work_offset: str
    coolant: str
    spin_up: float
    number: int = 1
    away: float | None = None
    zero: Zero = OF_THE_PART
    blank: tuple[Point, Point] | None = None

    @property
    def title(self) -> str:
        """The name as controllers can read it."""
        return re.sub(r"[^A-Z0-9_-]", "_", self.name.upper())[:LONGEST_NAME]


@dataclass(slots=True)
class Program:
    """A program that is being written; `lines` have no numbers yet."""

    machine: Machine
    shares: Budget
    setup: Setup
    height: float
    limits: Mapping[str, Limit] = field(default_factory=dict)
    speller: Speller = field(init=False)
    lines: list[str] = field(default_factory=list)
    _tool: Tool | None = None
    _nominal: str = ""
    _wet: bool = False

    def __post_init__(self) -> None:
        grid = Grid(self.shares.decimals, MM_PER[self.setup.unit])
        machine = self.machine
        words = dialect(machine.dialect)
        zero = self.setup.zero
        self.speller = Speller(grid, self.shares, machine.arcs, words, machine.numbers, zero)

    def start(self, about: Iterable[str]) -> None:
        """The first lines and the comments on the whole program."""
        self.lines += filled(
            self.machine.program.start,
            name=self.setup.title,
            number=f"{self.setup.number:04d}",
            unit=self.machine.unit.of(self.setup.unit),
        )
        self.lines += self._blank()
        self.lines += self._commented(about)

    def _blank(self) -> list[str]:
        """The blank for the controller's graphics, if it is known."""
        if self.setup.blank is None:
            return []
        grid, signed = self.speller.grid, self.speller.dialect.signed
        words = {
            f"{axis}{k}": grid.text(grid.steps(place), signed=signed)
            for k, corner in enumerate(self.setup.blank)
            for axis, place in zip("xyz", corner, strict=True)
        }
        return filled(self.machine.program.blank, **words)

    def operation(self, operation: Operation, following: Operation | None) -> None:
        """One operation, from its comments to its last move, and away if the operator comes."""
        first = self._tool is None
        said = self._compensate(operation)
        grid, zero = self.speller.grid, self.setup.zero
        comments = self._commented(about_operation(operation.cut, grid, zero, said))
        self.lines += () if first else comments
        moves = programmed(operation)
        before = moves[1] if not first and len(moves) > 1 else None
        self._state(operation.cut.tool, halting=isinstance(before, Stop))
        if isinstance(before, Stop):  # before anything is switched on for the operation
            self._wait(before)
            moves = moves[2:]
        self._start(operation.travel[0].end, comments if first else ())
        for move in moves:
            if isinstance(move, Stop):
                self._halt(move)
            else:
                self.speller.move(move)
        self.lines += self.speller.take()
        if self._plain_retract:  # while the tool's length is in force
            other = following is None or following.tool.number != operation.tool.number
            leaves = other or (following is not None and bool(following.cut.stop))
            self._retract(self._away if leaves else self.height)

    def _compensate(self, operation: Operation) -> str:
        """Make the words of its compensation; what the operator has to know of it, or nothing."""
        self._nominal, self.speller.switches = "", {}
        words, limit = self.machine.compensation, self.limits.get(operation.name)
        if words is None or limit is None:
            return ""
        if limit.mode == WEAR:
            grid = self.speller.grid
            radius = grid.text(grid.steps(limit.radius))
            self._nominal = words.nominal.format(radius=radius)
        number = str(limit.tool)
        self.speller.switches = {
            side: getattr(words, side).format(tool=number, nominal=self._nominal).rstrip()
            for side in ("left", "right")
        }
        self.speller.switches["off"] = words.off
        return limit.sentence(words, partial(spelled, unit=self.setup.unit))

    def end(self) -> None:
        """Away from the part, everything off."""
        machine = self.machine
        self._dry()
        self._retract(self._away)
        self.lines += machine.spindle.off
        self.lines += machine.smoothing.end if machine.smoothing else ()
        unit = machine.unit.of(self.setup.unit)
        self.lines += filled(machine.program.end, name=self.setup.title, unit=unit)

    def _state(self, tool: Tool, *, halting: bool) -> None:
        """Modal state and tool; the cutter is above the part, or its place is unknown.

        `halting` says whether the operator comes next: then the spindle is off.
        """
        machine, before = self.machine, self._tool
        self.speller.restart()
        self._dry()
        unit = machine.unit.of(self.setup.unit)
        offset = self.setup.work_offset
        blocks = filled(machine.program.safe_start, unit=unit, work_offset=offset)
        self.lines += [block for block in blocks if block]
        self.lines += self._smoothing()
        if (before is not None and not self._plain_retract) or machine.retract.first:
            self._retract(self.height)
        other = before is not None and before.number != tool.number
        if before is not None and (other or halting or machine.tool_change.repeat):
            self.lines += machine.spindle.off
        if before is None or other or machine.tool_change.repeat:
            words = {"tool": str(tool.number), "speed": self._speed(tool)}
            blocks = filled(machine.tool_change.change, **words, nominal=self._nominal)
            self.lines += [block.rstrip() for block in blocks]
        self._tool = tool
        if not self._moving_offset:
            self.lines += self._offset()

    def _start(self, at: Point, comments: Iterable[str] = ()) -> None:
        """Spindle on, to the clearance height, coolant on.

        A machine that goes across first is above everything, and goes down above `at` with the
        spindle turning; others first leave the work, which the cutter may touch.
        """
        if self.machine.tool_change.approach == "xy-first":
            self._turn()
            self.lines += comments
            self.speller.across(at)
            self.lines += self.speller.take()
            self._down()
            self._wetted()
        else:
            self._down()
            self._turn()
            self._wetted()
            self.lines += comments

    def _turn(self) -> None:
        """The spindle on, up to its speed."""
        machine, tool = self.machine, self._tool
        assert tool is not None
        self.lines += filled(machine.spindle.clockwise, speed=self._speed(tool))
        if self.setup.spin_up > 0.0:
            seconds = self.setup.spin_up
            time = str(round(1e3 * seconds)) if machine.dwell.unit == "ms" else number(seconds)
            self.lines += filled(machine.dwell.blocks, dwell=time)

    def _down(self) -> None:
        """To the clearance height."""
        if self._moving_offset:
            self.lines += self._offset()
            self.speller.reached(self.height)
        else:
            self.speller.retract(self.height)
            self.lines += self.speller.take()

    def _wetted(self) -> None:
        """Coolant on, if tool or scene want any."""
        assert self._tool is not None
        coolant = self._tool.coolant or self.setup.coolant
        if coolant != "off":
            self.lines += self.machine.coolant.blocks(coolant)
            self._wet = True

    def _halt(self, stop: Stop) -> None:
        """Everything off for the operator, and back to where the cutter was, from above."""
        at = self.speller.place
        self.lines += self.speller.take()
        self._dry()
        self._retract(self._away)
        self.lines += self.machine.spindle.off
        self._wait(stop)
        if not self._moving_offset:
            self.lines += self._offset()
        self._start((at.real, at.imag, self.height))

    def _wait(self, stop: Stop) -> None:
        """For the operator, who may move the machine."""
        self.lines += (*self._commented([stop.note]), *self.machine.program.stop)
        self.speller.restart()

    def _retract(self, z: float) -> None:
        """Up to the machine's retract, or to the height `z` [mm] if it is not there."""
        if self._plain_retract and self.speller.at_height(z):
            return
        self.lines += filled(self.machine.retract.blocks, z=self.speller.height(z))
        if self._plain_retract:
            self.speller.reached(z)
        else:
            self.speller.forget()

    def _dry(self) -> None:
        if self._wet:
            self.lines += self.machine.coolant.off
        self._wet = False

    @property
    def _away(self) -> float:
        """Z [mm] at which tools are changed and the operator works."""
        return self.height if self.setup.away is None else self.setup.away

    @property
    def _plain_retract(self) -> bool:
        """Whether the machine's retract is a height above the part."""
        return self.machine.retract.is_a_height

    @property
    def _moving_offset(self) -> bool:
        """Whether the blocks of the length offset move to the clearance height."""
        return any("{z}" in block for block in self.machine.tool_change.length_offset)

    def _offset(self) -> list[str]:
        assert self._tool is not None
        words = {"tool": str(self._tool.number), "z": self.speller.height(self.height)}
        return filled(self.machine.tool_change.length_offset, **words)

    def _smoothing(self) -> Sequence[str]:
        smoothing = self.machine.smoothing
        if smoothing is None:
            return ()
        if self.shares.blending > 0.0:
            value = self.shares.blending / MM_PER[self.setup.unit]
            return filled(smoothing.on, p=f"{value:.{self.shares.decimals}f}")
        return smoothing.off

    def _speed(self, tool: Tool) -> str:
        speed = tool.spindle_speed
        return str(round(speed)) if self.machine.spindle.whole_speed else number(speed)

    def _commented(self, texts: Iterable[str]) -> list[str]:
        return commented([text for text in texts if text], self.machine.text)


def written(
    toolpath: Toolpath, machine: Machine, shares: Budget, setup: Setup, about: Iterable[str]
) -> Program:
    """The program of a toolpath; `about` are the comments on the whole of it.

    Raises
    ------
    GeometryError
        If there is no room for a compensation.
    """
    limits = limits_of(toolpath.operations)
    program = Program(machine, shares, setup, toolpath.heights.clearance, limits)
    program.start(about)
    operations = toolpath.operations
    for operation, following in zip_longest(operations, operations[1:]):
        program.operation(operation, following)
    program.end()
    return program


def numbered(lines: Iterable[str], machine: Machine) -> list[str]:
    """`lines` with the numbers that the profile asks for: on blocks alone, in klartext on all.

    A block of several lines becomes as many, with one number.
    """
    step = machine.text.line_numbers
    if step is None:
        return [part for line in lines for part in line.split("\n")]
    klartext = machine.dialect == "klartext"
    plain = ("\n",) if klartext else (machine.text.comment_open.strip(), "%", "O")
    found: list[str] = []
    count = 0 if klartext else 1
    for line in lines:
        first, *others = line.split("\n")
        if first.startswith(plain):
            found.append(first)
        else:
            found += (f"{'' if klartext else 'N'}{step * count} {first}", *others)
            count += 1
    return found


# -- speller --------------------------------------------------------------------------------------
# Moves written as blocks of a program.
#
# Coordinates are whole multiples of the last printed decimal from the start, so that what is
# checked here is what the controller reads.


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


# -- dialects -------------------------------------------------------------------------------------
# The words of a block in the dialects of controllers: ISO's G words, and klartext.


Coordinates = Sequence[tuple[str, str]]
"""Axes with their printed coordinates."""


class Dialect(Protocol):
    """How blocks of moves are spelled; coordinates are printed already."""

    @property
    def signed(self) -> bool:
        """Whether coordinates have a plus sign."""

    def rapid(self, end: Coordinates) -> str:
        """A traverse to `end`."""

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """A straight cut; `feed` is empty where it goes on, `switch` are the words of the
        controller's compensation that it switches.
        """

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """A circular cut, in one block or two."""


class Iso:
    """G and M words; the centre is written as I and J."""

    signed: Final = False

    def rapid(self, end: Coordinates) -> str:
        """As G0."""
        return _spelled("G0", _words(end))

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """As G1."""
        return _spelled("G1", switch, _words(end), _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """As G3 or G2."""
        own = [("IJ"["XY".index(axis)], value) for axis, value in centre]
        return [_spelled("G3" if ccw else "G2", _words(end), _words(own), _feed(feed))]


class Klartext:
    """Heidenhain's conversational blocks; the centre has a block of its own."""

    signed: Final = True

    def __init__(self) -> None:
        self._centre = ""
        self._side = "R0"

    def rapid(self, end: Coordinates) -> str:
        """As L with FMAX."""
        return _spelled("L", _words(end), "R0 FMAX")

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """As L, which repeats the side of the compensation."""
        self._side = switch or self._side
        return _spelled("L", _words(end), self._side, _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """As C, behind a CC for another centre."""
        found = []
        if (block := _spelled("CC", _words(centre))) != self._centre:
            found.append(block)
            self._centre = block
        found.append(_spelled("C", _words(end), "DR+" if ccw else "DR-", _feed(feed)))
        return found


def dialect(name: str) -> Dialect:
    """That of a machine profile."""
    return Klartext() if name == "klartext" else Iso()


def _words(coordinates: Coordinates) -> str:
    return " ".join(axis + value for axis, value in coordinates)


def _feed(feed: str) -> str:
    return f"F{feed}" if feed else ""


def _spelled(*parts: str) -> str:
    return " ".join(part for part in parts if part)
