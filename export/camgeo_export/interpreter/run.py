"""A milling program run as its controller would run it, led by a machine profile."""

from __future__ import annotations

import math
import re
from codecs import BOM_UTF8
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import Final

from camgeo.design.linting import MOST, Bench, LineFinding, Linted
from camgeo.errors import FileError
from camgeo.milling.holding import OTHER
from camgeo.milling.machine import LONGEST_LINE, Machine
from camgeo.milling.zero import Zero
from camgeo.reading import PROGRAM, check_text, lines_of
from camgeo_export.gcode.moves import CutterMove, Event, Loop, closed_paths
from camgeo_export.interpreter.compensation import Radius, centres
from camgeo_export.interpreter.controller import Controller, State, controller_of
from camgeo_export.interpreter.decode import decode
from camgeo_export.interpreter.execute import Executor
from camgeo_export.interpreter.iso import Block, Enough, Findings, Words, without_comments, words_of
from camgeo_export.interpreter.klartext import Klartext
from camgeo_export.interpreter.motion import Mover

NOTE: Final = re.compile(r"\(([^()]*)\)|;(.*)")
"""A comment in brackets, or one up to the end of the line, in whatever dialect."""

OPERATION: Final = "operation "
"""A comment that begins with it names the operation that follows."""

IN_SPINDLE: Final = re.compile(r"tool (\d{1,6}):", re.ASCII | re.IGNORECASE)
"""A comment that names the tool of a program, where programs do not change it."""

G_WORDS: Final = re.compile(r"(?:N\d++\s*+)?+[GOT]\s*+\d|[%(]", re.ASCII)
"""The first block of a program in G words."""

CONVERSATIONAL: Final = re.compile(r"(?:\d++\s++)?+BEGIN\s++PGM\b", re.ASCII)
"""The first block of a program in Heidenhain's conversational format."""

NAME: Final = re.compile(r"(\S)\s*+\d++\s*+", re.ASCII)
"""A block with the number of a program."""


ASSIGNMENT: Final = re.compile(r"(?:N\d++\s*+)?+(?:#|R\d++\s*+=)", re.ASCII)
"""A block that gives a parameter its value, and moves nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """A program that was run.

    Attributes
    ----------
    mm_per_unit : of the unit of length of its first cut; NaN if it states none.
    step : last printed decimal [mm].
    blending : how far the controller may leave the programmed path in a cut [mm]; 0 for the exact
        path, infinite without a bound.
    naive_cam : how far it may move points before that [mm].
    moves, events : in the order of running.
    comments : those that stand alone in their lines, without brackets; what is said right before
        a stop is for the operator and left out.
    findings : by line.
    complete : whether the program was read to its end, not up to the last finding allowed.
    central : whether all moves are those of the cutter's centre, also compensated ones.
    """

    mm_per_unit: float
    step: float
    blending: float
    naive_cam: float
    moves: tuple[CutterMove, ...]
    comments: tuple[str, ...]
    events: tuple[Event, ...]
    findings: tuple[LineFinding, ...]
    complete: bool
    central: bool = False

    def loops(self, gap: float = 0.0) -> list[Loop]:
        """Closed runs of cuts, see `camgeo_export.gcode.moves`."""
        return closed_paths(self.moves, gap)

    @property
    def compensated(self) -> CutterMove | None:
        """The first move whose path is not that of the cutter's centre; None if there is none."""
        if self.central:
            return None
        return next((move for move in self.moves if move.compensation), None)

    def in_the_part(self, zero: Zero) -> Run:
        """The same in the coordinates of the part, in which the program's `zero` is somewhere."""
        z, part_of, turned = zero.z, zero.part_of, bool(zero.turned)
        if not (zero.place or z or turned):
            return self
        moved = tuple(
            replace(
                move,
                start=part_of(move.start),
                end=part_of(move.end),
                centre=part_of(move.centre) if move.kind == "arc" else move.centre,
                sweep=-move.sweep if turned and move.sweep else move.sweep,
                z_start=move.z_start + z,
                z_end=move.z_end + z,
                compensation=OTHER[move.compensation] if turned else move.compensation,
            )
            for move in self.moves
        )
        events = tuple(replace(each, at=part_of(each.at), z=each.z + z) for each in self.events)
        return replace(self, moves=moved, events=events)

    def centred(self, radius: Radius) -> Run:
        """The same along the cutter's centre, with what `radius` says of compensated moves."""
        return replace(self, moves=centres(self.moves, radius), central=True)

    def refuse(self, *concerns: str) -> None:
        """Raise FileError with the first finding that concerns one of these, or anything."""
        for finding in self.findings:
            if not concerns or finding.concerns in concerns:
                raise FileError(str(finding))


def run(
    text: str,
    machine: Machine,
    bench: Bench | None = None,
    most: int = MOST,
    fatal: Collection[str] = (),
) -> Run:
    """Run a program.

    Parameters
    ----------
    text : of the program.
    machine : profile of the controller.
    bench : what the program does not say of the work; by default Z 0 is the top of the stock.
    most : findings after which the program is not read further.
    fatal : concerns of findings of which one is enough.

    Raises
    ------
    FileError
        If the program is beyond the limits of what is read.
    """
    return run_bytes(text.encode("utf-8", "replace"), machine, bench, most, fatal)


def run_bytes(
    data: bytes,
    machine: Machine,
    bench: Bench | None = None,
    most: int = MOST,
    fatal: Collection[str] = (),
) -> Run:
    """Run a program given as bytes, like `run`."""
    check_text(data, PROGRAM, "the program")
    program = _Program(machine, bench or Bench(), Findings(most, fatal))
    complete = True
    try:
        program.read_ends(data)
        for number, line in enumerate(_lines_of(data, machine), start=1):
            program.read(number, line)
        program.finish()
    except Enough:
        complete = False
    return program.result(complete)


def _lines_of(data: bytes, machine: Machine) -> Iterator[str]:
    """The lines of a program as the controller tells them apart."""
    return lines_of(data, newline=CARRIAGE_RETURNS[machine.reading.carriage_return])


def notes_of(text: str) -> list[str]:
    """The comments in a text of any dialect, without brackets."""
    return [(inside or after).strip() for inside, after in NOTE.findall(text)]


KEPT: Final = 20_000
"""Blocks of which the words are kept for later lines with the same text."""


class _Program:
    """A program while it is read."""

    def __init__(self, machine: Machine, bench: Bench, findings: Findings) -> None:
        self._machine = machine
        self._bench = bench
        self._controller: Controller = controller_of(machine)
        self._findings = findings
        self._state = State()
        if machine.smoothing is None:
            self._state.blending = self._state.naive_cam = 0.0
        self._mover = Mover(self._controller, self._state, bench, self._findings)
        self._executor = Executor(self._controller, self._mover, self._state, self._findings)
        self._klartext = Klartext(self._controller, self._state, self._findings)
        self._names = {name.upper(): name for name in bench.operations}
        self._comments: list[str] = []
        self._before_block = 0
        self._percent = 0
        self._first = 0
        self._blocks = 0
        self._said_after = False
        self._known: dict[str, Block] = {}  # sound ones by their text: depths repeat their path

    def read_ends(self, data: bytes) -> None:
        """Judge what lines do not show of the bytes of the program."""
        check_ends(data, self._machine, self._findings)

    def read(self, number: int, line: str) -> None:
        """Read one line and run its block."""
        if not check_line(number, line, self._machine, self._findings):
            self._state.lose()
            return
        line = line.replace("\r", "")
        self._first = self._first or (number if line.strip() else 0)
        klartext = self._machine.dialect == "klartext"
        brackets = self._controller.brackets and not klartext
        may_end = self._machine.reading.open_comment
        text, notes = without_comments(number, line, brackets, self._findings, may_end=may_end)
        block = text.strip().upper()
        alone = not block or (klartext and block.isdigit())
        for note in notes:
            self._note(note, alone)
        if alone:
            return
        if not klartext and block.startswith("%"):
            self._control(number, block)
            return
        if self._state.ended and klartext and self._klartext.is_end(block):
            return
        if self._ended(number):
            return
        self._blocks += 1
        self._check_dialect(number, block, klartext)
        events = len(self._executor.events)
        self._block(number, block, klartext)
        if any(event.kind == "stop" for event in self._executor.events[events:]):
            del self._comments[self._before_block :]
        self._before_block = len(self._comments)

    def _check_dialect(self, number: int, block: str, klartext: bool) -> None:
        """A program in the other dialect is found once, at its first block; raises Enough."""
        if self._blocks > 1:
            return
        if klartext and G_WORDS.match(block):
            what, other = "a program in G words, not in conversational format", "iso"
        elif not klartext and CONVERSATIONAL.match(block):
            what = "a program in Heidenhain's conversational format, not in G words"
            other = "klartext"
        else:
            return
        allowed = f'a machine profile with dialect = "{other}"'
        self._findings.add(number, "unreadable", what, allowed=allowed)
        raise Enough

    def _block(self, number: int, block: str, klartext: bool) -> None:
        """Run the block of a line."""
        if klartext:
            for each in self._klartext.blocks(number, block):
                self._executor.run(each)
            return
        named = NAME.fullmatch(block)
        if named and named[1] in self._machine.reading.number_marks:
            return
        if block.startswith("/"):
            what = "a block that a switch of the controller skips"
            self._findings.add(number, "unsupported", what)
            block = block.lstrip("/0123456789 ")
        if (known := self._known.get(block)) is not None:
            self._executor.run(known.at_line(number))
            return
        before = len(self._findings.found)
        words = words_of(number, block, self._controller.extended, self._findings)
        if words is None:
            if not ASSIGNMENT.match(block):
                self._state.lose()
            return
        check_number(words, self._machine.reading.largest_number, self._findings)
        decoded = decode(words, self._controller, self._findings)
        if len(self._findings.found) == before and len(self._known) < KEPT:
            self._known[block] = decoded.at_line(number)
        self._executor.run(decoded)

    def _note(self, note: str, alone: bool) -> None:
        """What a comment says of the program."""
        state = self._state
        if alone:
            self._comments.append(note)
        if note.lower().startswith(OPERATION):
            name = note[len(OPERATION) :].strip()
            state.operation = self._names.get(name.upper(), name)
        if self._controller.changes_tools or state.tool:
            return
        if found := IN_SPINDLE.match(note):
            self._executor.put_in(int(found[1]))

    def _control(self, number: int, block: str) -> None:
        """`%` begins a program, and ends it if it began one."""
        taken, name = self._machine.reading.percent, self._machine.name
        if taken == "none":
            self._findings.add(number, "unknown-word", f"{name} does not take %")
        elif (
            taken == "first"
            and not self._state.ended
            and (block != "%" or not (self._percent or self._first == number))
        ):
            what = f"{name} takes % alone in the first line and the last, and not elsewhere"
            self._findings.add(number, "unknown-word", what)
        elif self._percent and not self._state.ended and self._blocks:
            self._state.ended = True
            self._findings.add(number, "no-end", "% ends the program before M2 or M30 does")
        self._percent += 1

    def _ended(self, number: int) -> bool:
        if not self._state.ended:
            return False
        if not self._said_after:
            self._findings.add(number, "after-end", "block after the end of the program")
            self._said_after = True
        return True

    def finish(self) -> None:
        """Judge the end of the program."""
        if not self._state.ended:
            what = "the program does not end"
            ends = "END PGM" if self._machine.dialect == "klartext" else "M2 or M30"
            self._findings.add(0, "no-end", what, allowed=ends)
        elif not self._mover.moves:
            self._findings.add(0, "nothing", "the program moves nothing")
        for event in self._executor.events:
            low = event.z < self._bench.free
            if low and event.kind in ("tool change", "stop", "spindle off"):
                where = f"at Z {event.z:g} mm, below the safe height"
                allowed = f"Z {self._bench.free:g} mm or more"
                self._findings.add(event.line, "low-stop", f"{event.word} {where}", "", allowed)

    def result(self, complete: bool) -> Run:
        """What there is."""
        state = self._state
        return Run(
            state.scale if math.isnan(state.cut_scale) else state.cut_scale,
            state.step,
            state.blending if state.cut_blending < 0.0 else state.cut_blending,
            state.naive_cam if state.cut_blending < 0.0 else state.cut_naive_cam,
            tuple(self._mover.moves),
            tuple(self._comments),
            tuple(self._executor.events),
            tuple(sorted(self._findings.found, key=lambda each: each.line or math.inf)),
            complete,
        )


class GcodeLinter:
    """The interpreter as `camgeo lint` asks for it."""

    def lint(self, data: bytes, machine: Machine, bench: Bench) -> Linted:
        """All findings; FileError for data beyond the limits of a program."""
        found = run_bytes(data, machine, bench)
        wanted = {finding.line for finding in found.findings}
        texts = {
            number: line.removesuffix("\r").replace("\r", " ")
            for number, line in enumerate(_lines_of(data, machine), start=1)
            if number in wanted
        }
        return Linted(found.findings, texts, len(found.moves), found.complete)


LINTER = GcodeLinter()


# -- text -----------------------------------------------------------------------------------------
# Limits of a program as a text: lengths of lines, characters, numbers of blocks, `%`.


UNCOUNTED: Final = re.compile(r"\([^)]*+\)?+|;.*+|\s++", re.ASCII)
"""Comments and blanks of a line."""

CARRIAGE_RETURNS: Final = {"blank": "\n", "end": None, "unknown": None}
"""How the lines of a program are told apart, by what the controller does with a carriage return
alone: as `io.TextIOWrapper` has it."""


def check_line(line: int, text: str, machine: Machine, findings: Findings) -> bool:
    """Find what the controller cannot read of a line as a text; whether it is read at all."""
    form = machine.text
    long = len(text) > LONGEST_LINE
    code = machine.reading.counted == "code" and not long
    counted = UNCOUNTED.sub("", text) if code and len(text) > form.longest_line else text
    size = len(counted if counted.isascii() else counted.encode("utf-8", "replace"))
    if size > form.longest_line:
        what = f"a line of {size} characters"
        findings.add(line, "line-length", what, allowed=f"at most {form.longest_line}")
        if long:
            return False
    shown = text.removesuffix("\r")
    if shown.isascii() and shown.isprintable():
        return True
    wrong = next((each for each in text if each not in "\t\r" and not " " <= each <= "~"), "")
    if wrong:
        what = f"the character {wrong!a} at column {text.index(wrong) + 1}"
        findings.add(line, "characters", what, allowed="printable ASCII")
    return True


def check_ends(data: bytes, machine: Machine, findings: Findings) -> None:
    """Find what of a program's bytes the controller takes otherwise than an editor shows."""
    if data.startswith(BOM_UTF8) and not machine.reading.byte_order_mark:
        what = "the program begins with a byte order mark"
        findings.add(1, "characters", what, allowed="printable ASCII")
    if machine.reading.carriage_return == "end" or b"\r" not in data:
        return
    before, alone, _ = data.replace(b"\r\n", b"\n").partition(b"\r")
    if alone:
        does = {"blank": "which this controller reads over: the block goes on behind it"}
        what = does.get(machine.reading.carriage_return, "of which it is not known what it does")
        line = 1 + before.count(b"\n")
        findings.add(line, "line-end", f"a carriage return without a line feed, {what}")


def check_number(words: Words, largest: int, findings: Findings) -> None:
    """Find the number of a block that is too large."""
    for letter, number in words.words:
        if letter == "N" and number.value > largest:
            what, allowed = f"N{number.text} is too large", f"at most {largest}"
            findings.add(words.line, "line-number", what, allowed=allowed)
