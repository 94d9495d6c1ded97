"""A milling program run as its controller would run it, led by a machine profile."""

from __future__ import annotations

import math
import re
from codecs import BOM_UTF8
from collections.abc import Collection, Iterator
from typing import Final

from camgeo.design.linting import Linted, WorkData
from camgeo.milling.machine import LONGEST_LINE, Machine
from camgeo.reading import PROGRAM, check_text, text_lines
from camgeo.units import MM_PER
from camgeo_export.interpreter.controller import (
    AXES,
    UNKNOWN,
    Block,
    BlockReader,
    Controller,
    Decoder,
    Klartext,
    State,
)
from camgeo_export.interpreter.motion import Mover
from camgeo_export.interpreter.moves import (
    Enough,
    Event,
    Findings,
    ProgramRun,
)

MOST: Final = 1_000
"""Most findings of one program; when they are reached, it is read no further."""

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


def run(
    program: str | bytes,
    machine: Machine,
    bench: WorkData | None = None,
    most: int = MOST,
    fatal: Collection[str] = (),
) -> ProgramRun:
    """Run a program.

    Parameters
    ----------
    program : its text, or its bytes.
    machine : profile of the controller.
    bench : what the program does not say of the work; by default Z 0 is the top of the stock.
    most : findings after which the program is not read further.
    fatal : concerns of findings of which one is enough.

    Raises
    ------
    FileError
        If the program is beyond the limits of what is read.
    """
    data = program.encode("utf-8", "replace") if isinstance(program, str) else program
    check_text(data, PROGRAM, "the program")
    findings = Findings(most, fatal)
    reader = _Program(machine, bench or WorkData(), findings)
    complete = True
    try:
        check_ends(data, machine, findings)
        for number, line in enumerate(_program_lines(data, machine), start=1):
            reader.read(number, line)
        reader.finish()
    except Enough:
        complete = False
    return reader.result(complete)


def _program_lines(data: bytes, machine: Machine) -> Iterator[str]:
    """The lines of a program as the controller separates them."""
    return text_lines(data, newline=CARRIAGE_RETURNS[machine.reading.carriage_return])


MOST_KNOWN: Final = 20_000
"""Blocks of which the words are kept for later lines with the same text."""


class _Program:
    """A program while it is read."""

    def __init__(self, machine: Machine, bench: WorkData, findings: Findings) -> None:
        self._machine = machine
        self._bench = bench
        self._controller = Controller.from_machine(machine)
        self._findings = findings
        self._state = State()
        if machine.smoothing is None:
            self._state.blending = self._state.naive_cam = 0.0
        self._mover = Mover(self._controller, self._state, bench, self._findings)
        self._executor = Executor(self._controller, self._mover, self._state, self._findings)
        self._decoder = Decoder(self._controller, self._state, self._findings)
        self._klartext = Klartext(self._controller, self._state, self._findings)
        self._names = {name.upper(): name for name in bench.operations}
        self._comments: list[str] = []
        self._before_block = 0
        self._percent = 0
        self._first = 0
        self._blocks = 0
        self._end_passed = False
        self._known: dict[str, Block] = {}  # sound ones by their text: depths repeat their path

    def read(self, number: int, line: str) -> None:
        """Read one line and run its block."""
        if not check_line(number, line, self._machine, self._findings):
            self._state.lose()
            return
        line = line.replace("\r", "")
        self._first = self._first or (number if line.strip() else 0)
        klartext = self._machine.dialect == "klartext"
        text, notes = self._decoder.without_comments(number, line)
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
        if self._state.ended:
            if not self._end_passed:
                self._findings.add(number, "after-end", "block after the end of the program")
            self._end_passed = True
            return
        self._blocks += 1
        self._check_dialect(number, block, klartext)
        events = len(self._executor.events)
        self._block(number, block, klartext)
        if any(event.kind == "stop" for event in self._executor.events[events:]):
            del self._comments[self._before_block :]
        self._before_block = len(self._comments)

    def _check_dialect(self, number: int, block: str, klartext: bool) -> None:
        """Report a program in the other dialect, once, at its first block; then raise Enough."""
        if self._blocks > 1:
            return
        if klartext and G_WORDS.match(block):
            what, other = "a program in G words, not in conversational format", "iso"
        elif not klartext and CONVERSATIONAL.match(block):
            what = "a program in Heidenhain's conversational format, not in G words"
            other = "klartext"
        else:
            return
        self._findings.add(
            number, "unreadable", what, allowed=f'a machine profile with dialect = "{other}"'
        )
        raise Enough

    def _block(self, number: int, block: str, klartext: bool) -> None:
        """Run the block of a line."""
        if klartext:
            for klartext_block in self._klartext.blocks(number, block):
                self._executor.run(klartext_block)
            return
        named = NAME.fullmatch(block)
        if named and named[1] in self._machine.reading.number_marks:
            return
        if block.startswith("/"):
            self._findings.add(
                number, "unsupported", "a block that a switch of the controller makes it skip"
            )
            block = block.lstrip("/0123456789 ")
        if (known := self._known.get(block)) is not None:
            self._executor.run(known.at_line(number))
            return
        reported_count = len(self._findings.reported)
        decoded = self._decoder.read_block(number, block)
        if decoded is None:
            if not ASSIGNMENT.match(block):
                self._state.lose()
            return
        if len(self._findings.reported) == reported_count and len(self._known) < MOST_KNOWN:
            self._known[block] = decoded.at_line(number)
        self._executor.run(decoded)

    def _note(self, note: str, alone: bool) -> None:
        """Take from a comment what it says of the program."""
        state = self._state
        if alone:
            self._comments.append(note)
        if note.lower().startswith(OPERATION):
            name = note[len(OPERATION) :].strip()
            state.operation = self._names.get(name.upper(), name)
        if self._controller.changes_tools or state.tool:
            return
        if match := IN_SPINDLE.match(note):
            # In the spindle from the start, its length set.
            state.chosen = state.tool = state.offset = int(match[1])

    def _control(self, number: int, block: str) -> None:
        """Take a `%`, which begins a program, and ends it if one has begun."""
        percent, name = self._machine.reading.percent, self._machine.name
        if percent == "none":
            self._findings.add(number, "unknown-word", f"{name} does not take %")
        elif (
            percent == "first"
            and not self._state.ended
            and (block != "%" or not (self._percent or self._first == number))
        ):
            what = f"{name} takes % alone in the first line and the last, and not elsewhere"
            self._findings.add(number, "unknown-word", what)
        elif self._percent and not self._state.ended and self._blocks:
            self._state.ended = True
            self._findings.add(number, "no-end", "% ends the program before M2 or M30")
        self._percent += 1

    def finish(self) -> None:
        """Check the end of the program."""
        if not self._state.ended:
            what = "the program has no end"
            ends = "END PGM" if self._machine.dialect == "klartext" else "M2 or M30"
            self._findings.add(0, "no-end", what, allowed=ends)
        elif not self._mover.moves:
            self._findings.add(0, "nothing", "the program contains no move")
        for event in self._executor.events:
            low = event.z < self._bench.free
            if low and event.kind in ("tool change", "stop", "spindle off"):
                where = f"at Z {event.z:g} mm, below the safe height"
                allowed = f"Z {self._bench.free:g} mm or more"
                self._findings.add(event.line, "low-stop", f"{event.word} {where}", "", allowed)

    def result(self, complete: bool) -> ProgramRun:
        """The program as far as it was read."""
        state = self._state
        return ProgramRun(
            state.scale if math.isnan(state.cut_scale) else state.cut_scale,
            state.step,
            state.blending if state.cut_blending < 0.0 else state.cut_blending,
            state.naive_cam if state.cut_blending < 0.0 else state.cut_naive_cam,
            tuple(self._mover.moves),
            tuple(self._comments),
            tuple(self._executor.events),
            tuple(sorted(self._findings.reported, key=lambda finding: finding.line or math.inf)),
            complete,
        )


class GcodeLinter:
    """The interpreter in the form that `camgeo lint` needs."""

    def lint(self, data: bytes, machine: Machine, bench: WorkData) -> Linted:
        """All findings; FileError for data beyond the limits of a program."""
        program = run(data, machine, bench)
        wanted = {finding.line for finding in program.findings}
        texts = {
            number: line.removesuffix("\r").replace("\r", " ")
            for number, line in enumerate(_program_lines(data, machine), start=1)
            if number in wanted
        }
        return Linted(program.findings, texts, len(program.moves), program.complete)


LINTER = GcodeLinter()


# -- text -----------------------------------------------------------------------------------------
# Limits of a program as a text: lengths of lines, characters, numbers of blocks, `%`.


UNCOUNTED: Final = re.compile(r"\([^)]*+\)?+|;.*+|\s++", re.ASCII)
"""Comments and blanks of a line."""

CARRIAGE_RETURNS: Final = {"blank": "\n", "end": None, "unknown": None}
"""The separator of lines for `io.TextIOWrapper`, by what the controller does with a carriage return
alone."""


def check_line(line: int, text: str, machine: Machine, findings: Findings) -> bool:
    """Report what the controller cannot read of a line as a text; return whether it is read."""
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
    visible = text.removesuffix("\r")
    if visible.isascii() and visible.isprintable():
        return True
    wrong = next(
        (
            character
            for character in text
            if character not in "\t\r" and not " " <= character <= "~"
        ),
        "",
    )
    if wrong:
        what = f"the character {wrong!a} at column {text.index(wrong) + 1}"
        findings.add(line, "characters", what, allowed="printable ASCII")
    return True


def check_ends(data: bytes, machine: Machine, findings: Findings) -> None:
    """Report bytes of a program that the controller takes otherwise than an editor shows them."""
    if data.startswith(BOM_UTF8) and not machine.reading.byte_order_mark:
        findings.add(
            1, "characters", "the program begins with a byte order mark", allowed="printable ASCII"
        )
    if machine.reading.carriage_return == "end" or b"\r" not in data:
        return
    head, alone, _ = data.replace(b"\r\n", b"\n").partition(b"\r")
    if alone:
        what = (
            "a carriage return without a line feed, which this controller takes for a blank"
            if machine.reading.carriage_return == "blank"
            else "a carriage return without a line feed, whose effect on this controller is unknown"
        )
        findings.add(1 + head.count(b"\n"), "line-end", what)


# -- blocks ---------------------------------------------------------------------------------------
# One block run by the controller, in the order in which controllers take its words.
#
# The order is that of LinuxCNC (docs/src/gcode/overview.adoc, "G-code Order of Execution"), which
# is that of RS274/NGC; where other controllers differ, the block is ambiguous, and a finding says
# so.


EVENTS: Final = {
    "tool change": "tool",
    "spindle off": "spindle",
    "stop": "flow",
    "end": "flow",
    "dwell": "dwell",
}
"""Groups of the words that cause events."""

ALWAYS: Final = frozenset("FNOS")
"""Words that any block may have."""

MOTION: Final = frozenset({"motion"})

TOOLS: Final = frozenset({"D", "H", "T", "OFFN"})
"""Words that do something without a G or M word."""

SHORTEST_DWELL, LONGEST_DWELL = 0.05, 60.0
"""Seconds that a dwell may reasonably take; others are in another unit, probably."""

SIMPLE: Final = ("plane", "distance", "centres", "cycle", "return")
"""Modal groups whose words change nothing but the mode."""


class Executor(BlockReader):
    """Runs blocks on one state.

    Attributes
    ----------
    events : stops, tool changes and dwells so far.
    """

    def __init__(
        self, controller: Controller, mover: Mover, state: State, findings: Findings
    ) -> None:
        super().__init__(controller, state, findings)
        self.events: list[Event] = []
        self._mover = mover
        self._used: set[str] = set()

    def run(self, block: Block) -> None:
        """Run one block."""
        if block.broken:
            self._mover.skip(block)
            return
        self._used = set(ALWAYS)
        # Most blocks only move, and some set a feed.
        moving = block.codes.keys() <= MOTION and not block.actions
        # Some controllers read F in the unit that was active before the block.
        late = "unit" in block.codes and self._reading.feed_unit == "before"
        if late:
            self._feed_and_speed(block)
        if not moving:
            self._check_order(block)
            self._unit(block)
        if not late:
            self._feed_and_speed(block)
        if not moving or not block.values.keys().isdisjoint(TOOLS):
            self._modes(block)
        self._used |= self._mover.move(block)
        if not moving:
            if self._ends_late:
                self._spindle(block, switching_off=True)
                self._coolant(block, switching_off=True)
            self._flow(block)
        for letter in block.values:
            if letter not in self._used and letter != "tolerance":
                what = f"no function of the block uses the word {letter}"
                self._report(block, "unused-word", what, block.values[letter].text)

    @property
    def _ends_late(self) -> bool:
        """Whether words that switch spindle and coolant off take effect after the motion."""
        return self._controller.machine.dialect == "klartext"

    def _modes(self, block: Block) -> None:
        """What a block switches before it moves."""
        self._tool(block)
        self._spindle(block, switching_off=False)
        self._coolant(block, switching_off=False)
        if not self._ends_late:
            self._spindle(block, switching_off=True)
            self._coolant(block, switching_off=True)
        self._dwell(block)
        if block.codes.get("plane", "plane XY") != (self._state.mode("plane") or "plane XY"):
            self._check_compensated(block, ("plane",))
        for group in SIMPLE:
            if group in block.codes:
                self._state.modes[group] = block.codes[group]
        if "cycle" in block.codes:
            self._mover.end_cycle(block)
        self._compensation(block)
        self._check_compensated(block, ("length", "work offset", "path mode"))
        self._length(block)
        self._work_offset(block)
        self._path_mode(block)

    def _check_compensated(self, block: Block, groups: tuple[str, ...]) -> None:
        """Report what the controller does not change under compensation."""
        for group in groups:
            if self._state.side and group in block.codes and group in self._reading.compensated:
                self._report(block, "compensation", f"{block.words[group]} under compensation")

    def _check_order(self, block: Block) -> None:
        """Report blocks whose words controllers run in different orders."""
        stopping = [
            block.words[group]
            for group in ("spindle", "coolant")
            if block.codes.get(group) in ("spindle off", "coolant off")
        ]
        cutting = block.codes.get("motion", self._state.mode("motion")) not in ("", "rapid")
        moving = any(axis in block.values for axis in AXES)
        if stopping and moving and cutting and self._controller.machine.dialect != "klartext":
            what = f"{stopping[0]} in a block that cuts: controllers differ in their order"
            self._report(block, "order", what, allowed="a block of its own")
        unit = block.codes.get("unit", self._state.mode("unit"))
        changes = "F" in block.values and unit != (self._state.mode("unit") or unit)
        if changes and self._reading.feed_unit == "before":
            what = f"F with {block.words['unit']} counts in the previous unit, not in the new one"
            self._report(block, "order", what, allowed="F in the next block")

    # -- words, in the order of execution ---------------------------------------------------------

    def _unit(self, block: Block) -> None:
        if "unit" not in block.codes:
            return
        unit = block.codes["unit"]
        scale = MM_PER["inch"] if unit == "inch" else MM_PER["mm"]
        if self._state.scale not in (scale, math.inf) and not math.isnan(self._state.scale):
            self._report(block, "unit-change", "the unit changes within the program")
        self._state.scale = scale
        self._state.modes["unit"] = unit

    def _feed_and_speed(self, block: Block) -> None:
        state = self._state
        mode = block.codes.get("feed mode")
        again = self._reading.feed_mode == "resets"
        if mode is not None and (again or mode != state.mode("feed mode")):
            if again or state.mode("feed mode"):
                state.feed = 0.0  # in another unit from here on
            state.modes["feed mode"] = mode
            if mode == "inverse time":
                self._report(
                    block, "unsupported", f"{block.words['feed mode']} is not supported by camgeo"
                )
        timed = self._controller.dwell_letters if "dwell" in block.actions else ""
        if "S" in block.values and "S" not in timed:
            state.speed = block.value("S")
        if "F" in block.values and "F" not in timed:
            per_turn = state.mode("feed mode") == "feed per revolution"
            numbers = self._controller.machine.numbers
            unit = state.mode("unit")
            part = numbers.inch_feed if unit == "inch" else 1.0
            value = block.values["F"].in_increments(numbers.feed_increment, unit)
            if value != block.value("F"):
                text = f"F{block.values['F'].text}"
                what = f"{text} without a decimal point counts in increments: {value:g} a minute"
                self._report(block, "decimal-point", what, allowed=f"{text}.")
            state.feed = value * self._state.unit * part * (state.speed if per_turn else 1.0)
            self._check_feed(block)

    def _check_feed(self, block: Block) -> None:
        dynamics = self._controller.machine.dynamics
        if dynamics is not None and self._state.feed > dynamics.rapid_feed:
            what = "the feed exceeds the rapid traverse rate of the machine"
            self._report(
                block, "feed", what, f"{self._state.feed:g} mm/min",
                f"at most {dynamics.rapid_feed:g} mm/min",
            )  # fmt: skip

    def _tool(self, block: Block) -> None:
        state = self._state
        if "T" in block.values:
            state.chosen = int(max(block.value("T"), 0.0))
        self._used |= set("T")
        changes = block.codes.get("tool") == "tool change"
        if not (changes or ("T" in block.values and not self._controller.changes_tools)):
            return
        if changes and not state.chosen:
            self._report(block, "missing-word", "a tool change without the tool number T")
        if changes and state.side:
            self._report(block, "compensation", "a tool change under compensation")
        self._leave_tool()
        state.tool, state.measured = state.chosen, 0
        lasting = self._controller.length_letter == "D" and state.offset > 0
        if lasting or self._controller.machine.dialect == "klartext":
            self._activate_length(state.tool)  # its length comes into force with it, or its edge D
        if changes:
            state.modes["spindle"] = "spindle off"  # controllers stop it
            self._event(block, "tool change")

    def _leave_tool(self) -> None:
        """Check the coolant of the tool that leaves the spindle."""
        state = self._state
        if state.dry and state.used_coolant:
            self._findings.add(
                state.dry, "coolant", "a cut without coolant, which this tool uses elsewhere"
            )
        state.dry, state.used_coolant = 0, False

    def _spindle(self, block: Block, *, switching_off: bool) -> None:
        """Switch the spindle if the block does: off if `switching_off`, else on."""
        spindle = block.codes.get("spindle")
        if spindle is None or (spindle == "spindle off") != switching_off:
            return
        if spindle == "spindle off":
            self._event(block, "spindle off")
        elif not self._state.speed > 0.0:
            self._report(block, "no-spindle", f"{block.words['spindle']} without a speed S")
        if spindle == "spindle counter-clockwise":
            self._report(
                block, "spindle-sense", "the spindle turns counter-clockwise: cutters cut clockwise"
            )
        self._state.modes["spindle"] = spindle

    def _coolant(self, block: Block, *, switching_off: bool) -> None:
        """Switch the coolant if the block does: off if `switching_off`, else on."""
        coolant = block.codes.get("coolant")
        if coolant is not None and (coolant == "coolant off") == switching_off:
            self._state.modes["coolant"] = block.codes["coolant"]
            self._state.used_coolant |= self._state.coolant != "off"

    def _dwell(self, block: Block) -> None:
        """Wait; the word that states how long is taken from the block."""
        if "dwell" not in block.actions:
            return
        letters, form = self._controller.dwell_letters, self._controller.machine.dwell
        letter = next((letter for letter in letters if letter in block.values), "")
        if not letter:
            self._report(
                block, "missing-word", f"{block.words['dwell']} without its time", allowed=letters
            )
            return
        number = block.values.pop(letter)
        text, seconds = f"{letter}{number.text}", number.value
        if letter == "S":  # revolutions of the spindle
            seconds *= 60.0 / (self._state.speed or math.inf)
        elif letter == letters[0] and form.unit != "s":
            if number.has_point and not form.point_seconds:
                self._report(
                    block, "number", "a dwell in whole milliseconds takes no decimal point", text
                )
            # Milliseconds, unless a decimal point turns them into seconds.
            seconds /= 1.0 if number.has_point and form.point_seconds else 1000.0
        if seconds != 0.0 and not SHORTEST_DWELL <= seconds <= LONGEST_DWELL:
            what = f"a dwell of {seconds:g} s: {text} counts in {form.unit} here"
            self._report(block, "dwell", what, allowed=f"{SHORTEST_DWELL:g} to {LONGEST_DWELL:g} s")
        self._event(block, "dwell", seconds)

    def _compensation(self, block: Block) -> None:
        state = self._state
        if "OFFN" in block.values:
            self._used.add("OFFN")
            state.oversize = block.value("OFFN") * self._state.unit
        meaning = block.codes.get("compensation")
        if meaning is None:
            return
        if meaning == "compensation off":
            if state.side:
                state.left_compensation = block.line
            state.modes["compensation"] = meaning
            state.radius_offset, state.stated_radius = 0, math.nan
            return
        if state.side:
            self._report(block, "compensation", "compensation is already on")
        self._used |= set("D")
        word = block.words["compensation"]
        state.stated_radius = math.nan
        if word.endswith(".1"):  # D is the diameter itself
            state.stated_radius = 0.5 * block.value("D") * self._state.unit
        elif "D" in block.values:
            if block.value("D") % 1.0:
                text = block.values["D"].text
                self._report(block, "number", f"D{text} is not the number of an offset")
            state.radius_offset = int(max(block.value("D"), 0.0))
        elif not state.radius_offset:
            state.radius_offset = state.tool
        state.modes["compensation"] = meaning
        self._mover.enter(block)

    def _length(self, block: Block) -> None:
        state = self._state
        if self._controller.length_letter == "D" and "D" in block.values:
            self._used |= set("D")
            self._activate_length(state.tool if block.value("D") > 0.0 else 0)
        meaning = block.codes.get("length")
        if meaning == "length offset off":
            self._activate_length(0)
        elif meaning == "length offset":
            self._used |= set("HZ")
            number = int(max(block.value("H", state.tool), 0.0))
            if state.tool and number != state.tool:
                what = f"the length of tool {number} is activated with tool {state.tool}"
                self._report(block, "tool-length", what, allowed=f"H{state.tool}")
            self._activate_length(number)

    def _activate_length(self, number: int) -> None:
        """Activate the length of a tool: the same height of the spindle is another Z after that."""
        state = self._state
        if not self._controller.changes_tools:
            number = state.tool  # Z was set with it
        state.measured = state.tool if number else state.measured
        if number != state.offset and math.isfinite(state.z):
            state.last_z, state.z = state.z, math.nan
        state.offset = number

    def _work_offset(self, block: Block) -> None:
        state = self._state
        if "work offset" not in block.codes:
            return
        word = block.words["work offset"]
        if state.work_offset not in ("", word):
            state.place = UNKNOWN
            state.z = state.z if math.isinf(state.z) else math.nan
        state.work_offset = word
        state.modes["work offset"] = "work offset"

    def _path_mode(self, block: Block) -> None:
        state = self._state
        mode = block.codes.get("path mode")
        if mode is not None:
            state.modes["path mode"] = mode
            state.blending = state.naive_cam = 0.0
            if mode == "continuous path":
                self._used |= set("PQ")
                # Without P the controller keeps its speed at any deviation; without Q, Q is P.
                smooth = self._controller.smoothing_letter(block.words["path mode"])
                p = block.value("P", math.inf) if smooth else math.inf
                state.blending = p * self._state.unit
                q = block.value("Q", p) if self._controller.groups & {"centres"} else 0.0
                state.naive_cam = q * self._state.unit if math.isfinite(q) else state.blending
        if "smoothing" in block.codes:
            self._smoothing(block)

    def _smoothing(self, block: Block) -> None:
        state = self._state
        letter = self._controller.smoothing_letter(block.words["smoothing"])
        self._used |= set(f"PQER{letter}")
        number = block.values.get("tolerance") or (block.values.get(letter) if letter else None)
        state.naive_cam = 0.0
        if block.names.get("smoothing") == "off" or number is None:
            state.blending = 0.0
        else:
            state.blending = number.value * self._state.unit

    def _flow(self, block: Block) -> None:
        state = self._state
        flow = block.codes.get("flow")
        if flow is None or flow == "optional stop":
            return
        if flow == "stop":
            self._event(block, "stop")
            return
        self._leave_tool()
        for group, what in (("spindle", "the spindle turns"), ("coolant", "the coolant flows")):
            mode = state.mode(group)
            if mode not in ("", f"{group} off"):
                # M2 and M30 switch them off on most controllers, not on all.
                self._report(block, "left-on", f"{what} at the end of the program")
        if state.side:
            self._report(block, "left-on", "compensation is on at the end of the program")
        self._event(block, "end")
        state.ended = True

    def _event(self, block: Block, kind: str, seconds: float = 0.0) -> None:
        state = self._state
        word = block.words.get(EVENTS[kind]) or block.words.get("flow", kind)
        z = state.last_z if math.isnan(state.z) else state.z
        self.events.append(Event(kind, word, state.place, z, state.tool, seconds, block.line))
