"""G-code: the milling program of the part in the words of a machine profile."""

from __future__ import annotations

import cmath
import math
import re
import textwrap
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import zip_longest
from typing import Final

from camgeo.design.product import SECOND as NAME
from camgeo.design.product import Product, display_title
from camgeo.design.writing import Written
from camgeo.errors import Fault, GeometryError, SceneError, ToleranceError
from camgeo.milling.compensation import OffsetLimit, compensation_mode, offset_limits, programmed
from camgeo.milling.cut import Cut
from camgeo.milling.machine import (
    ROUNDING_SHARE,
    ROUNDING_UNITS,
    Machine,
    load,
)
from camgeo.milling.machining_time import toolpath_times
from camgeo.milling.milling import MIRRORED_SIDE, TURNING_NOTE, WEAR, GcodeSpec, Stock, Tool
from camgeo.milling.moves import (
    ArcFeed,
    Feed,
    Operation,
    Point,
    Rapid,
    Stop,
    Toolpath,
    Zero,
    arc_sweep,
    described,
    too_long,
)
from camgeo.numeric.checked import one_of
from camgeo.reading import PROGRAM_LINES
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.verify.gcode import measure as deviation_of

ENDINGS: Final = {"lf": "\n", "crlf": "\r\n"}


class GcodeWriter:
    """Writes a milling program."""

    format = FORMAT
    measure = staticmethod(deviation_of)

    def write(self, product: Product, tolerance: float) -> Written:
        """The program, in the product's unit; path blending counts against `tolerance` [mm]."""
        spec = product.milled.gcode
        machine = load(spec.machine)
        setup = program_setup(product, spec, machine)
        shares = budget(machine, product.unit, tolerance)
        toolpath = product.milled.toolpath(shares.fit)
        whole = product.milled.whole
        if whole is None:
            watched = product.milled.safe(toolpath, tolerance)
        else:  # findings on the whole job are reported with its first program
            watched = () if product.program else whole.safe(whole.toolpath(shares.fit), tolerance)
        cuts = [operation.cut for operation in toolpath.operations]
        _check_tools(cuts, machine)
        comments = program_comments(product, machine, shares, cuts, product.scene_hash)
        program = write_program(toolpath, machine, shares, setup, comments)
        lines = number_lines(program.lines, machine)
        _check_limits(lines, program, machine)
        side = side_sentence(product)
        facts: dict[str, int | float | str] = {
            "operations": len(toolpath.operations),
            **({"side": side} if side else {}),
            "zero": setup.zero.sentence,
            "arcs": program.speller.arcs,
            "lines": program.speller.lines,
            "decimals": shares.decimals,
            "budget_fit_mm": _short(shares.fit),
            "budget_rounding_mm": _short(shares.rounding),
            "budget_chords_mm": _short(shares.chord),
            "path_blending_mm": _short(shares.blending),
            **(
                {"controller_arcs_mm": _short(shares.interpolation)} if shares.interpolation else {}
            ),
        }
        if program.limits:
            facts["compensation"] = ", ".join(
                f"{limit.operation} {limit.mode} {limit.most:.3f} mm"
                for limit in program.limits.values()
            )
        if machine.dynamics is not None:
            smoothing = shares.blending if shares.blending > 0.0 else None
            times = toolpath_times(
                toolpath, machine.dynamics, chord=shares.interpolation, smoothing=smoothing
            )
            facts["machining_time_s"] = round(sum(time.seconds for time in times), 1)
            facts["machining_times"] = ", ".join(f"{t.name} {t.seconds:.1f} s" for t in times)
        ending = ENDINGS[machine.text.line_ending]
        return Written("".join(line + ending for line in lines).encode("ascii"), facts, watched)

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or one for each program where the machine cannot change tools."""
        return product.programs


def program_setup(product: Product, spec: GcodeSpec, machine: Machine) -> Setup:
    """What the scene asks of the program; SceneError if it asks for what the machine lacks."""
    offset = spec.work_offset or next(iter(machine.work_offsets))
    allowed = {
        "coolant": machine.coolant.kinds,
        "work_offset": tuple(machine.work_offsets),
        "compensation": machine.compensations,
    }
    faults = []
    wanted = {("output.gcode.coolant", spec.coolant), ("output.gcode.work_offset", offset)}
    wanted |= {("tool.coolant", cut.tool.coolant or "off") for cut in product.milled.cuts}
    wanted |= {("output.gcode.compensation", compensation_mode(cut)) for cut in product.milled.cuts}
    for key, value in sorted(wanted):
        try:
            one_of(key, value, allowed[key.rpartition(".")[2]])
        except GeometryError as error:
            faults.append(Fault(error.key, repr(value), f"{error.message} for {machine.name}"))
    if faults:
        raise SceneError(faults)
    spin_up_time = machine.spindle.spin_up if spec.spin_up is None else spec.spin_up
    words = machine.work_offsets[offset]
    milled, away = product.milled, spec.tool_change_height
    first_programs = 0 if milled.first is None else len(milled.first.programs)
    # Main disc and pair alternate, so the further programs of one disc are numbered two apart.
    number = spec.program_number + product.position + 2 * (first_programs + (product.program or 0))
    assert milled.spec is not None  # for there are cuts
    blank = milled.zero.box(milled.spec.stock, milled.part)
    return Setup(
        product.name,
        product.unit,
        words,
        spec.coolant,
        spin_up_time,
        number,
        away,
        milled.zero,
        blank,
    )


def _short(length: float) -> float:
    """A share of the budget [mm], rounded to four significant digits."""
    return float(f"{length:.4g}")


def _check_tools(cuts: list[Cut], machine: Machine) -> None:
    tools = dict.fromkeys(cut.tool.number for cut in cuts)
    if len(tools) > 1 and not machine.tool_change.change:
        raise machine.error(
            f"a program cannot change tools, but tools {' and '.join(map(str, tools))} are needed:"
            " write a program for each of them, or use a profile with tool_change.change"
        )


def _check_limits(lines: list[str], program: Program, machine: Machine) -> None:
    for line in lines:
        if len(line) > machine.text.line_length:
            raise machine.error(f"its text.line_length is too short for the block {line}")
    grid = program.speller.grid
    largest = grid.mm(program.speller.reach) / grid.mm_per_unit
    if largest > machine.numbers.largest:
        raise machine.error(f"its numbers.largest is too small for the coordinate {largest:g}")


WRITER = GcodeWriter()


# -- frame ----------------------------------------------------------------------------------------
# A whole program: the moves of each operation within the blocks of a machine profile.
#
# Each operation states the modal state, the tool and its length, spindle and coolant, and
# approaches its first point from above, so that it can be restarted alone.


LONGEST_NAME: Final = 24
"""Most characters of a program's name that controllers show."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What a scene asks of a program beyond its moves.

    Attributes
    ----------
    name : of the part.
    unit : of length.
    work_offset : words that select it.
    coolant : one of the machine's kinds, with tools that do not state theirs.
    spin_up_time : dwell after the start of the spindle [s].
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
    spin_up_time: float
    number: int = 1
    away: float | None = None
    zero: Zero = field(default_factory=Zero)
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
    limits: Mapping[str, OffsetLimit] = field(default_factory=dict)
    speller: Speller = field(init=False)
    lines: list[str] = field(default_factory=list)
    _tool: Tool | None = None
    _nominal: str = ""
    _wet: bool = False

    def __post_init__(self) -> None:
        grid = Grid(self.shares.decimals, MM_PER[self.setup.unit])
        machine = self.machine
        words = Klartext() if machine.dialect == "klartext" else Iso()
        self.speller = Speller(grid, self.shares, machine, words, self.setup.zero)

    def start(self, comments: Iterable[str]) -> None:
        """The first lines and the comments on the whole program."""
        self.lines += fill_blocks(
            self.machine.program.start,
            name=self.setup.title,
            number=f"{self.setup.number:04d}",
            unit=self.machine.unit.for_unit(self.setup.unit),
        )
        if self.setup.blank is not None:  # for the controller's graphics
            grid, signed = self.speller.grid, self.speller.dialect.signed
            words = {
                f"{axis}{k}": grid.text(grid.steps(place), signed=signed)
                for k, corner in enumerate(self.setup.blank)
                for axis, place in zip("xyz", corner, strict=True)
            }
            self.lines += fill_blocks(self.machine.program.blank, **words)
        self.lines += self._commented(comments)

    def operation(self, operation: Operation, following: Operation | None) -> None:
        """Write one operation, from its comments to its last move, and retract if the operator has
        to work next.
        """
        first = self._tool is None
        note = self._compensate(operation)
        grid, zero = self.speller.grid, self.setup.zero
        cut = operation.cut
        depths = " ".join(grid.text(grid.steps(depth - zero.z)) for depth in cut.depths)
        comments = self._commented((f"operation {cut.name}", f"depths {depths}", note, cut.note))
        self.lines += () if first else comments
        moves = programmed(operation)
        second_move = moves[1] if not first and len(moves) > 1 else None
        self._state(operation.cut.tool, halting=isinstance(second_move, Stop))
        if isinstance(second_move, Stop):  # before anything is switched on for the operation
            self._wait(second_move)
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
        """Prepare the words of its radius compensation; return what the operator must know about
        it, or an empty text.
        """
        self._nominal, self.speller.switches = "", {}
        words, limit = self.machine.compensation, self.limits.get(operation.name)
        if words is None or limit is None:
            return ""
        if limit.mode == WEAR:
            grid = self.speller.grid
            self._nominal = words.nominal.format(radius=grid.text(grid.steps(limit.radius)))
        number = str(limit.tool)
        self.speller.switches = {
            side: getattr(words, side).format(tool=number, nominal=self._nominal).rstrip()
            for side in ("left", "right")
        }
        self.speller.switches["off"] = words.off
        return limit.sentence(words, partial(length_text, unit=self.setup.unit))

    def end(self) -> None:
        """Write the end of the program: retract, and switch everything off."""
        machine = self.machine
        self._stop_coolant()
        self._retract(self._away)
        self.lines += machine.spindle.off
        self.lines += machine.smoothing.end if machine.smoothing else ()
        unit = machine.unit.for_unit(self.setup.unit)
        self.lines += fill_blocks(machine.program.end, name=self.setup.title, unit=unit)

    def _state(self, tool: Tool, *, halting: bool) -> None:
        """Write modal state and tool; the cutter is above the part, or its place is unknown.

        `halting` says whether the operator comes next: then the spindle is off.
        """
        machine, previous_tool = self.machine, self._tool
        self.speller.restart()
        self._stop_coolant()
        unit = machine.unit.for_unit(self.setup.unit)
        blocks = fill_blocks(
            machine.program.safe_start, unit=unit, work_offset=self.setup.work_offset
        )
        self.lines += [block for block in blocks if block]
        self.lines += self._smoothing()
        if (previous_tool is not None and not self._plain_retract) or machine.retract.first:
            self._retract(self.height)
        other = previous_tool is not None and previous_tool.number != tool.number
        if previous_tool is not None and (other or halting or machine.tool_change.repeat):
            self.lines += machine.spindle.off
        if previous_tool is None or other or machine.tool_change.repeat:
            words = {"tool": str(tool.number), "speed": self._speed(tool)}
            blocks = fill_blocks(machine.tool_change.change, **words, nominal=self._nominal)
            self.lines += [block.rstrip() for block in blocks]
        self._tool = tool
        if not self._moving_offset:
            self.lines += self._offset()

    def _start(self, place: Point, comments: Iterable[str] = ()) -> None:
        """Switch the spindle on, move to the clearance height, and switch the coolant on.

        A machine that goes across first is above everything, and goes down above `place` with the
        spindle turning; others first leave the work, which the cutter may touch.
        """
        if self.machine.tool_change.approach == "xy-first":
            self._turn()
            self.lines += comments
            self.speller.across(place)
            self.lines += self.speller.take()
            self._down()
            self._start_coolant()
        else:
            self._down()
            self._turn()
            self._start_coolant()
            self.lines += comments

    def _turn(self) -> None:
        """Switch the spindle on, and wait until it is up to speed."""
        machine, tool = self.machine, self._tool
        assert tool is not None
        self.lines += fill_blocks(machine.spindle.clockwise, speed=self._speed(tool))
        if self.setup.spin_up_time > 0.0:
            seconds = self.setup.spin_up_time
            time = str(round(1e3 * seconds)) if machine.dwell.unit == "ms" else number(seconds)
            self.lines += fill_blocks(machine.dwell.blocks, dwell=time)

    def _down(self) -> None:
        """Move to the clearance height."""
        if self._moving_offset:
            self.lines += self._offset()
            self.speller.reached(self.height)
        else:
            self.speller.retract(self.height)
            self.lines += self.speller.take()

    def _start_coolant(self) -> None:
        """Switch the coolant on if the tool or the scene asks for it."""
        assert self._tool is not None
        coolant = self._tool.coolant or self.setup.coolant
        if coolant != "off":
            self.lines += self.machine.coolant.blocks(coolant)
            self._wet = True

    def _halt(self, stop: Stop) -> None:
        """Stop for the operator with everything off, then return from above to where the cutter
        was.
        """
        place = self.speller.place
        self.lines += self.speller.take()
        self._stop_coolant()
        self._retract(self._away)
        self.lines += self.machine.spindle.off
        self._wait(stop)
        if not self._moving_offset:
            self.lines += self._offset()
        self._start((place.real, place.imag, self.height))

    def _wait(self, stop: Stop) -> None:
        """Wait for the operator, who may move the machine."""
        self.lines += (*self._commented([stop.note]), *self.machine.program.stop)
        self.speller.restart()

    def _retract(self, z: float) -> None:
        """Retract as the machine does, or to the height `z` [mm] unless the cutter is there."""
        if self._plain_retract and self.speller.level(z) == self.speller.printed_position[2]:
            return
        self.lines += fill_blocks(self.machine.retract.blocks, z=self.speller.height(z))
        if self._plain_retract:
            self.speller.reached(z)
        else:
            self.speller.forget()

    def _stop_coolant(self) -> None:
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
        return fill_blocks(self.machine.tool_change.length_offset, **words)

    def _smoothing(self) -> Sequence[str]:
        smoothing = self.machine.smoothing
        if smoothing is None:
            return ()
        if self.shares.blending > 0.0:
            value = self.shares.blending / MM_PER[self.setup.unit]
            return fill_blocks(smoothing.on, p=f"{value:.{self.shares.decimals}f}")
        return smoothing.off

    def _speed(self, tool: Tool) -> str:
        speed = tool.spindle_speed
        return str(round(speed)) if self.machine.spindle.whole_speed else number(speed)

    def _commented(self, texts: Iterable[str]) -> list[str]:
        return comment_lines([text for text in texts if text], self.machine)


def write_program(
    toolpath: Toolpath, machine: Machine, shares: Budget, setup: Setup, comments: Iterable[str]
) -> Program:
    """The program of a toolpath; `comments` are those on the whole of it.

    Raises
    ------
    GeometryError
        If there is no room for a compensation.
    """
    limits = offset_limits(toolpath.operations)
    program = Program(machine, shares, setup, toolpath.heights.clearance, limits)
    program.start(comments)
    operations = toolpath.operations
    for operation, following in zip_longest(operations, operations[1:]):
        program.operation(operation, following)
    program.end()
    return program


def fill_blocks(blocks: Iterable[str], **words: str) -> list[str]:
    """`blocks` with `words` in place of the names in braces."""
    return [block.format(**words) for block in blocks]


def number_lines(lines: Iterable[str], machine: Machine) -> list[str]:
    """`lines` with the numbers that the profile asks for: on blocks alone, in klartext on all.

    A block of several lines gets one number, in its first line.
    """
    step = machine.text.line_numbers
    if step is None:
        return [part for line in lines for part in line.split("\n")]
    klartext = machine.dialect == "klartext"
    # What lines begin with that get no number.
    plain = ("\n",) if klartext else (machine.text.comment_open.strip(), "%", "O")
    numbered_lines: list[str] = []
    count = 0 if klartext else 1
    for line in lines:
        first, *others = line.split("\n")
        if first.startswith(plain):
            numbered_lines.append(first)
        else:
            numbered_lines += (f"{'' if klartext else 'N'}{step * count} {first}", *others)
            count += 1
    return numbered_lines


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
    machine : with the limits of its arcs and the form of its numbers.
    dialect : of the blocks.
    zero : of the program's coordinates.
    blocks : written since they were last taken.
    arcs, lines : cutting blocks written so far.
    switches : words of the controller's compensation, by what they switch it to on the machine.
    reach : largest magnitude of a coordinate so far, in steps of the grid.
    place : exact place of the cutter in the plane [mm].
    printed_position : where it is as printed, in steps; None where that is not known.
    """

    grid: Grid
    budget: Budget
    machine: Machine
    dialect: Iso
    zero: Zero = field(default_factory=Zero)
    blocks: list[str] = field(default_factory=list)
    switches: dict[str, str] = field(default_factory=dict)
    arcs: int = 0
    lines: int = 0
    reach: int = 0
    place: complex = 0j
    _exact_z: float = math.nan
    printed_position: tuple[int | None, int | None, int | None] = (None, None, None)
    _feed: str = ""

    def take(self) -> list[str]:
        """The blocks written since the last call."""
        blocks, self.blocks = self.blocks, []
        return blocks

    def forget(self) -> None:
        """Note that a block of the profile has moved the cutter along Z to an unknown height."""
        self.printed_position = (*self.printed_position[:2], None)

    def restart(self) -> None:
        """Repeat place and feed in the next blocks, as a program may be restarted here."""
        self.printed_position = (None, None, self.printed_position[2])
        self._feed = ""

    def height(self, height: float) -> str:
        """Z `height` [mm] as printed."""
        return self.grid.text(self.level(height), signed=self.dialect.signed)

    def level(self, height: float) -> int:
        """Z `height` [mm] in steps of the grid."""
        return self.grid.steps(height - self.zero.z)

    def reached(self, height: float) -> None:
        """Note that a block of the profile has moved the cutter to Z `height` [mm]."""
        self.printed_position = (*self.printed_position[:2], self.level(height))
        self._exact_z = height

    def retract(self, height: float) -> None:
        """Traverse to Z `height` [mm], from any cutter position."""
        self.blocks.append(self.dialect.rapid([("Z", self.height(height))]))
        self.reached(height)

    def across(self, end: Point) -> None:
        """Traverse to X and Y of `end` at the cutter's height, whatever it is."""
        x, y, _ = self._steps(end)
        self.blocks.append(self.dialect.rapid(self._texts((("X", x), ("Y", y)))))
        self.printed_position = (x, y, self.printed_position[2])
        self.place = complex(end[0], end[1])

    def move(self, move: Rapid | Feed | ArcFeed) -> None:
        """Write one move; FileError if the program becomes too long to be read."""
        if isinstance(move, Rapid):
            self._traverse(self._steps(move.end))
        elif isinstance(move, Feed):
            side = MIRRORED_SIDE[move.switch] if self.zero.turned else move.switch
            switch = self.switches.get(side, "")
            self._straight(self._steps(move.end), self._feed_text(move.feed), switch)
        else:
            self._arc(move)
        self.place, self._exact_z = complex(move.end[0], move.end[1]), move.end[2]

    def _steps(self, end: Point) -> Steps:
        x, y, z = self.zero.point_to_program(end)
        steps = self.grid.steps(x), self.grid.steps(y), self.grid.steps(z)
        self.reach = max(self.reach, *map(abs, steps))
        return steps

    def _texts(self, values: tuple[tuple[str, int], ...]) -> list[tuple[str, str]]:
        signed = self.dialect.signed
        return [(axis, self.grid.text(value, signed=signed)) for axis, value in values]

    def _traverse(self, end: Steps) -> None:
        if end[2] != self.printed_position[2] and (end[0], end[1]) != self.printed_position[:2]:
            raise ValueError("a traverse must move either in Z or in the plane")
        if changes := self._changes(end):
            self.blocks.append(self.dialect.rapid(changes))
        self.printed_position = end

    def _straight(self, end: Steps, feed: str, switch: str = "") -> None:
        if changes := self._changes(end):
            self.blocks.append(self.dialect.line(changes, self._new(feed), switch))
            self.lines += 1
            if self.lines > PROGRAM_LINES:
                raise too_long()
        self.printed_position = end

    def _changes(self, end: Steps) -> list[tuple[str, str]]:
        """The coordinates that change, X and Y together; none if the block moves nothing."""
        plane = (end[0], end[1]) != self.printed_position[:2]
        values: tuple[tuple[str, int], ...] = (("X", end[0]), ("Y", end[1])) if plane else ()
        return self._texts(
            values + ((("Z", end[2]),) if end[2] != self.printed_position[2] else ())
        )

    def _arc(self, move: ArcFeed) -> None:
        centre = complex(*move.centre)
        end = complex(move.end[0], move.end[1])
        arm = self.place - centre
        radius = abs(arm)
        sweep = arc_sweep(arm, end - centre, ccw=move.ccw)
        feed = self._feed_text(move.feed)
        helix = self._steps(move.end)[2] != self.printed_position[2]
        # r (1 - cos(sweep / 2)), in the form that does not cancel for flat arcs.
        sagitta = 2.0 * radius * math.sin(0.25 * sweep) ** 2
        chords = not self.budget.arcs or sagitta <= self.budget.chord
        chords = chords or (helix and not self.machine.arcs.helical)
        if (
            chords
            or not self.machine.arcs.smallest_radius <= radius <= self.machine.arcs.largest_radius
        ):
            low, high = self._exact_z, move.end[2]
            for part in _chord_ends(radius, sweep, self.budget.chord):
                point = centre + arm * cmath.exp(1j * sweep * part) if part < 1.0 else end
                z = low + (high - low) * part if part < 1.0 else high
                self._straight(self._steps((point.real, point.imag, z)), feed)
            return
        ccw = move.ccw != bool(self.zero.turned)
        self._printed_arc(self._steps(move.end), self.zero.to_program(centre), feed, ccw=ccw)

    def _printed_arc(self, end: Steps, centre: complex, feed: str, *, ccw: bool) -> None:
        """An arc block between printed points, with a centre recomputed for them and checked."""
        x, y, z = self.printed_position
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
        if self.machine.arcs.centre == "incremental":
            i, j = self.grid.steps(offset.real), self.grid.steps(offset.imag)
            printed = complex(self.grid.mm(i), self.grid.mm(j))
        else:
            i, j = self.grid.steps((start + offset).real), self.grid.steps((start + offset).imag)
            printed = complex(self.grid.mm(i), self.grid.mm(j)) - start
        mismatch = abs(abs(printed) - abs(target - start - printed))
        allowed = min(self.machine.arcs.radius_tolerance, self.budget.rounding)
        if mismatch > allowed:
            raise ToleranceError(
                f"radii of the arc to X{self.grid.text(end[0])} Y{self.grid.text(end[1])} differ",
                allowed,
                mismatch,
            )
        ends = (("X", end[0]), ("Y", end[1]), *((("Z", end[2]),) if end[2] != z else ()))
        middle = self._texts((("X", i), ("Y", j)))
        self.blocks += self.dialect.arc(self._texts(ends), middle, self._new(feed), ccw=ccw)
        self.arcs += 1
        self.printed_position = end

    def _feed_text(self, feed: float) -> str:
        """The feed [mm/min] in program units."""
        inches = self.grid.mm_per_unit != 1.0
        scale = self.grid.mm_per_unit * (self.machine.numbers.inch_feed if inches else 1.0)
        text = number(feed / scale, self.machine.numbers.feed_decimals)
        if float(text) <= 0.0:
            places = self.machine.numbers.feed_decimals
            raise GeometryError(
                f"a feed of {feed:.3g} mm/min is 0 in the {places} decimals of the program",
                "tool.feed",
                f"{feed:.3g}",
            )
        pointed = (
            self.machine.numbers.point == "required"
            or self.machine.numbers.feed_increment is not None
        )
        return f"{text}." if pointed and "." not in text else text

    def _new(self, feed: str) -> str:
        """The feed if it changes; else nothing."""
        if feed == self._feed:
            return ""
        self._feed = feed
        return feed


def _chord_ends(radius: float, sweep: float, sagitta: float) -> list[float]:
    """Ends of the fewest equal chords within `sagitta` of the arc, as fractions of it up to 1."""
    # A chord over the angle a has the sagitta 2 r sin(a / 4)^2; 1e-9 keeps rounding from adding a
    # chord to a quotient that is whole.
    ratio = math.sqrt(min(1.0, 0.5 * sagitta / radius))
    count = max(1, math.ceil(abs(sweep) / (4.0 * math.asin(ratio)) - 1e-9))
    return [(index + 1) / count for index in range(count)]


# -- dialects -------------------------------------------------------------------------------------
# The words of a block in the dialects of controllers: ISO's G words, and klartext.


Coordinates = Sequence[tuple[str, str]]
"""Axes with their printed coordinates."""


class Iso:
    """G and M words; the centre is written as I and J. Coordinates are printed already.

    Attributes
    ----------
    signed : whether coordinates have a plus sign.
    """

    signed = False

    def rapid(self, end: Coordinates) -> str:
        """A traverse to `end`, as G0."""
        return _spelled("G0", _words(end))

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """A straight cut, as G1; `feed` is empty where it goes on, `switch` are the words of the
        controller's compensation that it switches.
        """
        return _spelled("G1", switch, _words(end), _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """A circular cut, as G3 or G2."""
        centre_words = [("IJ"["XY".index(axis)], value) for axis, value in centre]
        return [_spelled("G3" if ccw else "G2", _words(end), _words(centre_words), _feed(feed))]


class Klartext(Iso):
    """Blocks in Heidenhain's conversational format, where the centre has its own block."""

    signed = True

    def __init__(self) -> None:
        self._centre = ""
        self._side = "R0"

    def rapid(self, end: Coordinates) -> str:
        """A traverse to `end`, as L with FMAX."""
        return _spelled("L", _words(end), "R0 FMAX")

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """A straight cut, as L, which repeats the side of the compensation."""
        self._side = switch or self._side
        return _spelled("L", _words(end), self._side, _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """A circular cut, as C, after a CC if the centre is another one."""
        blocks = []
        if (block := _spelled("CC", _words(centre))) != self._centre:
            blocks.append(block)
            self._centre = block
        blocks.append(_spelled("C", _words(end), "DR+" if ccw else "DR-", _feed(feed)))
        return blocks


def _words(coordinates: Coordinates) -> str:
    return " ".join(axis + value for axis, value in coordinates)


def _feed(feed: str) -> str:
    return f"F{feed}" if feed else ""


def _spelled(*parts: str) -> str:
    return " ".join(part for part in parts if part)


# -- comments -------------------------------------------------------------------------------------
# What a program says of itself.


SECOND = "second side:"
"""A comment that begins with it says that a program mills the second side."""

NUMBER_ROOM = 8
"""Characters of a line left for the number of its block."""


def program_comments(
    product: Product, machine: Machine, shares: Budget, cuts: Sequence[Cut], scene: str
) -> list[str]:
    """Comments on the whole program, in its unit, exact lengths also in mm; `scene` is the hash of
    the scene to be named.
    """
    unit, zero, milling = product.unit, product.milled.zero, product.milled.spec
    stock = Stock() if milling is None else milling.stock
    tools = {cut.tool.number: cut.tool for cut in cuts}

    def length(mm: float) -> str:
        return f"{mm / MM_PER[unit]:.4g} {unit}"

    blank = described(stock, product.milled.part, zero, unit)
    tolerance = f"{shares.tolerance!r} mm"
    if unit != "mm":
        tolerance = f"{shares.tolerance / MM_PER[unit]:.6g} {unit}, {tolerance}"
    parts = (
        f"part {product.name}",
        side_sentence(product),
        f"camgeo {product.version}, for {machine.name}",
        f"scene {scene}" if scene else "",
        f"unit {unit}, Z 0 on the upper face, origin on the cam axis"
        if zero.is_of_the_part
        else f"unit {unit}, {zero.sentence}",
        *_part_location(zero, unit),
        f"{'work' if zero.turned else 'blank'}: {blank}",
        f"tolerance {tolerance}",
        f"fit within {length(shares.fit)}, printed within {length(shares.rounding)}",
        f"chords within {length(shares.chord)}, path blending {length(shares.blending)}",
        f"arcs run within {length(shares.interpolation)}" if shares.interpolation > 0.0 else "",
        *(
            f"tool {key}: {tool.kind.replace('-', ' ')}, diameter"
            f" {length_text(tool.diameter, unit)}{f', {tool.name}' if tool.name else ''}"
            for key, tool in tools.items()
        ),
        *product.milled.notes,
        ""
        if display_title(product) == product.name
        else f"title {display_title(product)}",  # anyone's words: last
    )
    return [part for part in parts if part]


def side_sentence(product: Product) -> str:
    """Which side of the part a program mills, and how the work lies; empty if there is only one."""
    milled = product.milled
    if milled.first is not None:
        return f"{SECOND} the work is {TURNING_NOTE[milled.zero.turned]}"
    return "" if milled.second is None else f"first side: {product.name}-{NAME} follows it"


def _part_location(zero: Zero, unit: LengthUnit) -> Iterator[str]:
    """Where the part lies in the program's coordinates, if their zero is not that of the part."""
    if not zero.is_of_the_part:
        axis, top = zero.to_program(0j), 0.0 - zero.z
        places = [number(mm / MM_PER[unit]) for mm in (axis.real, axis.imag, top)]
        face = "lower face of the finished part" if zero.turned else (
            "upper face of the finished disc"
        )  # fmt: skip
        yield "cam axis at X {} Y {}, {} at Z {}".format(*places[:2], face, places[2])


def length_text(mm: float, unit: LengthUnit) -> str:
    """A length in the program's unit, and in mm if that is another."""
    text = f"{number(mm)} mm"
    return text if unit == "mm" else f"{number(mm / MM_PER[unit])} {unit}, {text}"


def comment_lines(texts: Iterable[str], machine: Machine) -> list[str]:
    """`texts` as comment lines, wrapped, as the controller can read them: plain ASCII without
    brackets.

    Characters that it cannot read are replaced.
    """
    form = machine.text
    width = form.line_length - len(form.comment_open) - len(form.comment_close)
    if form.line_numbers is not None:
        width -= NUMBER_ROOM
    replaced = str.maketrans({"(": "[", ")": "]"} | dict.fromkeys(form.forbidden, "_"))
    lines = []
    for text in texts:
        plain = to_ascii(text).translate(replaced)
        plain = plain.upper() if form.letters == "upper" else plain
        lines += textwrap.wrap(plain, width)
    return [form.comment_open + line + form.comment_close for line in lines]


SPELLED = str.maketrans(
    {
        "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "ẞ": "SS",
        "Ø": "dia. ", "ø": "dia. ", "⌀": "dia. ", "Æ": "Ae", "æ": "ae", "Œ": "Oe", "œ": "oe",
        "Å": "Aa", "å": "aa", "Ł": "L", "ł": "l", "°": " deg", "±": "+-", "×": "x", "µ": "u",
        "μ": "u", "–": "-", "—": "-", "’": "'", "…": "...",
    }
)  # fmt: skip
"""Characters of technical texts as ASCII."""


def to_ascii(text: str) -> str:
    """`text` in ASCII: special letters and signs spelled out, accents left off, others as "?"."""
    # Composed first, so that the table also finds letters with combining marks; then decomposed, so
    # that all other accents can be dropped.
    expanded = unicodedata.normalize("NFC", text).translate(SPELLED)
    parts = unicodedata.normalize("NFKD", expanded)
    plain = "".join(character for character in parts if not unicodedata.combining(character))
    return plain.encode("ascii", "replace").decode("ascii")


# -- blocks ---------------------------------------------------------------------------------------
# Printed numbers, and the shares of the tolerance that they and the controller take.


FEED_DECIMALS = 4
"""Decimals of a number that no profile limits, trailing zeros dropped."""


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

    def text(self, steps: int, *, signed: bool = False) -> str:
        """The printed number; zero has no minus, and a plus only if `signed`."""
        whole, part = divmod(abs(steps), self._scale)
        sign = "-" if steps < 0 else "+" if signed else ""
        return f"{sign}{whole}.{part:0{self.decimals}d}"


def number(value: float, decimals: int = FEED_DECIMALS) -> str:
    """A feed or a speed without trailing zeros, with at most `decimals` digits after the point."""
    return f"{value:.{decimals}f}".rstrip("0").rstrip(".")


CHORD_SHARE = 0.05
"""Share of the tolerance for arcs that are written as chords: nearly straight ones, and those whose
radius the machine does not accept."""

PROOF_SHARE = 0.05
"""Share of the tolerance left for the slack of the bound by which the program is measured."""

LEAST_FIT = 0.1
"""Least share of the tolerance left for the fit where numbers are coarse."""

SLACK = 1e-6
"""Tolerated error of a share: messages name tolerances with six digits, and such a one must do."""

LINE_SHARE = 0.3
"""Share of the tolerance for chords on a machine that gets lines alone."""

TRUSTED_SHARE = 0.5
"""Largest share of the tolerance that a controller's own arcs may take: one that needs more gets
lines."""


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
    arcs : whether arcs are written as such, if the machine takes them; else as chords.
    """

    tolerance: float
    decimals: int
    rounding: float
    chord: float
    blending: float
    fit: float
    interpolation: float = 0.0
    arcs: bool = True


def budget(machine: Machine, unit: LengthUnit, tolerance: float) -> Budget:
    """The shares of `tolerance` [mm] on `machine`."""
    decimals = machine.decimals(unit, tolerance)
    step = 10.0**-decimals
    rounding = ROUNDING_UNITS * step * MM_PER[unit]
    interpolation = machine.arcs.interpolation
    arcs = interpolation <= TRUSTED_SHARE * tolerance
    if not arcs:
        interpolation = 0.0
    chord = (CHORD_SHARE if arcs else LINE_SHARE) * tolerance
    left = tolerance * (1.0 - PROOF_SHARE) - rounding - chord - interpolation
    # Coarse numbers may leave too little for it.
    blending = machine.smoothed(tolerance, left - LEAST_FIT * tolerance) or 0.0
    # rounded down to what is printed
    blending = math.floor(blending / MM_PER[unit] / step + 1e-9) * step * MM_PER[unit]
    fit = left - blending
    # Blending takes no more than leaves this, up to a rounding. A tolerance that a message has
    # named as the least is enough.
    if left < (LEAST_FIT - SLACK) * tolerance and rounding > ROUNDING_SHARE * tolerance:
        least = rounding / (left + rounding - LEAST_FIT * tolerance) * tolerance
        raise ToleranceError(f"{decimals} decimals in a program are too coarse", tolerance, least)
    if fit <= 0.0:
        raise ToleranceError(
            "no part of the tolerance is left for the fit", tolerance, tolerance - fit
        )
    return Budget(tolerance, decimals, rounding, chord, blending, fit, interpolation, arcs)
