"""A whole program: the moves of each operation within the blocks of a machine profile.

Each operation states the modal state, the tool and its length, spindle and coolant, and approaches
its first point from above, so that it can be restarted alone.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import zip_longest
from typing import Final

from camgeo.toolpath.compensation import Limit, limits_of, programmed
from camgeo.toolpath.machine import Machine
from camgeo.toolpath.machine_tables import filled
from camgeo.toolpath.moves import Operation, Point, Stop, Toolpath
from camgeo.toolpath.tool import WEAR, Tool
from camgeo.toolpath.zero import OF_THE_PART, Zero
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.gcode.blocks import Budget, Grid, number
from camgeo_export.gcode.comments import about_operation, commented, spelled
from camgeo_export.gcode.dialects import dialect
from camgeo_export.gcode.speller import Speller

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
    program = Program(machine, shares, setup, toolpath.safe_height, limits)
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
