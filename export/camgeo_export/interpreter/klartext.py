"""Heidenhain's conversational format turned into blocks.

Read are BEGIN and END PGM, BLK FORM, TOOL CALL and TOOL DEF, lines L and LP, circles C, CP, CR, CT
and CTP with the centre CC, STOP, M words, the cycles 9 (dwell), 32 (tolerance) and 247 (datum).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final

from camgeo.reading import number_of
from camgeo.units import MM_PER
from camgeo_export.interpreter.controller import Controller, State
from camgeo_export.interpreter.decode import code, within_reach
from camgeo_export.interpreter.iso import Block, Findings, Number, normal, shown

NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)"

WORD: Final = re.compile(
    rf"""\s*+(?:
      (?P<sense>DR\s*+[-+])(?![\d.])
    | (?P<side>R[0LR])(?![\d.])
    | (?P<fast>FMAX|F\s++MAX)
    | (?P<auto>F\s*+AUTO)
    | (?P<letter>I?(?:PA|PR|[XYZ])|F|S|M|R|DL|DR|T)\s*+(?P<number>{NUMBER})
    )""",
    re.ASCII | re.VERBOSE,
)

HEAD: Final = re.compile(r"(?:\d++(?:\s++|$))?(.*)", re.ASCII | re.DOTALL)

BEGIN: Final = re.compile(r"(BEGIN|END)\s++PGM(?:\s++(.*?))?\s++(MM|INCH)", re.ASCII)

FORM: Final = re.compile(r"(?:BLK\s++FORM|TOOL\s++DEF)\b.*", re.ASCII)
"""Blocks that move nothing: the blank, and the data of a tool."""

CALL: Final = re.compile(r"TOOL\s++CALL(?:\s++(\d++|\"[^\"]*\"))?(?:\s++([XYZ])\b)?(.*)", re.ASCII)

DELTA: Final = re.compile(rf"\bD(?:R\s*+(?P<radius>{NUMBER})|[LR]\d*\s*+[-+]?[\d.]++)", re.ASCII)
"""What a call adds to the length and the radius of the tool in the table."""

CYCLE: Final = re.compile(r"CYCL\s++DEF\s++(\d++)(?:\.(\d++))?\b(.*)", re.ASCII)

PARAMETER: Final = re.compile(r"Q\d++\s*=.*", re.ASCII)

PATHS: Final = {
    "L": ("line", ""),
    "LP": ("line", "polar"),
    "C": ("circle", "pole"),
    "CP": ("circle", "polar"),
    "CR": ("circle", "radius"),
    "CT": ("tangent", "tangent"),
    "CTP": ("tangent", "tangent"),
}
"""Path functions: what they move along, and how an arc is stated."""

SIDES: Final = {
    "R0": "compensation off",
    "RL": "compensation left",
    "RR": "compensation right",
}

COMBINED: Final = {"M13": ("M3", "M8"), "M14": ("M4", "M8")}
"""Words that do what two others do."""

UNREAD: Final = re.compile(r"(APPR|DEP|RND|CHF|FN|LBL|CALL|FL|FC|FCT|FLT|Q|SEL|TCH|PLANE)\b")
"""First words of what is known, but not read."""

STILL: Final = frozenset({"FN", "LBL", "Q", "SEL"})
"""Those of them that move nothing."""

Form = Callable[[int, re.Match[str]], list[Block]]
"""From a line and its text to blocks."""


def _nothing(line: int, found: re.Match[str]) -> list[Block]:  # noqa: ARG001  one of the forms
    return []


class Klartext:
    """Turns lines into blocks."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings
        self._begun = False
        self._tool_feed: Number | None = None
        self._cycle = ""

    def blocks(self, line: int, text: str) -> list[Block]:
        """The blocks of a line in capitals, without comment."""
        head = HEAD.fullmatch(text)
        rest = (head[1] if head else text).rstrip(" ~")
        if not rest or rest.startswith("*"):
            return []
        if found := BEGIN.fullmatch(rest):
            return self._program(line, found)
        if not self._begun:
            self._begun = True
            self._findings.add(line, "frame", "a program begins with BEGIN PGM, its name and MM")
        for form, read in self._forms():
            if found := form.fullmatch(rest):
                return read(line, found)
        self._cycle = ""
        word, _, words = rest.partition(" ")
        if word in PATHS:
            return self._path(line, word, words)
        if word == "CC":
            self._centre(line, words)
            return []
        if word == "STOP":
            block = self._words(line, words)
            block.codes["flow"], block.words["flow"] = "stop", "STOP"
            return [block]
        if re.match(r"M\d", word):
            return [self._words(line, rest)]
        self._refuse(line, rest)
        return []

    def is_end(self, text: str) -> bool:
        """Whether a line is END PGM, which follows the M word that ends a program."""
        head = HEAD.fullmatch(text)
        return bool(head and head[1].startswith("END PGM"))

    def _forms(self) -> tuple[tuple[re.Pattern[str], Form], ...]:
        return (
            (FORM, _nothing),
            (CALL, self._tool_call),
            (CYCLE, self._cycle_of),
            (PARAMETER, self._parameter),
        )

    def _program(self, line: int, found: re.Match[str]) -> list[Block]:
        if found[1] == "BEGIN":
            self._begun = True
            unit = "mm" if found[3] == "MM" else "inch"
            self._state.scale = MM_PER["mm"] if unit == "mm" else MM_PER["inch"]
            self._state.modes["unit"] = unit
            return []
        block = Block(line)
        block.codes["flow"], block.words["flow"] = "end", "END PGM"
        return [block]

    def _tool_call(self, line: int, found: re.Match[str]) -> list[Block]:
        block = self._words(line, DELTA.sub("", found[3]))
        over = [number_of(each["radius"]) for each in DELTA.finditer(found[3]) if each["radius"]]
        self._state.oversize = (over[-1] or 0.0) * self._state.scale if over else 0.0
        if found[1] is None:  # another speed of the same tool
            self._tool_feed = block.values.get("F", self._tool_feed)
            return [block]
        self._tool_feed = block.values.get("F")
        number = found[1]
        if number.startswith('"'):
            what = "a tool called by name: its number is not known"
            self._findings.add(line, "unsupported", what, shown(number))
            return [block]
        block.values["T"] = Number(float(number[:9]), number)
        block.codes["tool"], block.words["tool"] = "tool change", "TOOL CALL"
        if found[2] != "Z":
            what = "TOOL CALL without Z as the axis of the tool"
            self._findings.add(line, "plane", what, allowed="TOOL CALL n Z")
        return [block]

    def _cycle_of(self, line: int, found: re.Match[str]) -> list[Block]:
        number, part, rest = found[1], found[2] or "0", found[3].strip()
        self._cycle = number
        block = Block(line)
        if number == "247":
            block.codes["work offset"] = "work offset"
            block.words["work offset"] = " ".join(found[0].split())
            return [block]
        if number == "32" and part == "1":
            block.codes["smoothing"], block.words["smoothing"] = "smoothing", "CYCL DEF 32"
            tolerance = re.fullmatch(rf"T\s*+({NUMBER})", rest)
            if tolerance and (value := number_of(tolerance[1])):
                block.values["tolerance"] = Number(value, tolerance[1])
            else:
                block.names["smoothing"] = "off"
            return [block]
        if number == "9" and part == "1":
            dwell = re.fullmatch(rf"(?:DWELL|V\.?ZEIT)\s*+({NUMBER})", rest)
            value = number_of(dwell[1]) if dwell else None
            if dwell and value is not None:
                block.actions["dwell"], block.words["dwell"] = "dwell", "CYCL DEF 9"
                block.values["P"] = Number(value, dwell[1])
                return [block]
            self._findings.add(line, "unreadable", "cannot be read", shown(rest))
            return []
        if number not in ("9", "32"):
            what = f"cycle {number} is outside what is read"
            self._findings.add(line, "unsupported", what)
        return []

    def _parameter(self, line: int, found: re.Match[str]) -> list[Block]:
        """A parameter of a cycle on a line of its own."""
        if not self._cycle:
            what = "parameters, expressions and control of flow are outside what is read"
            self._findings.add(line, "unsupported", what, shown(found[0]))
        return []

    def _path(self, line: int, function: str, words: str) -> list[Block]:
        block = self._words(line, words)
        motion, arc = PATHS[function]
        sense = block.names.pop("sense", "")
        if "R" in block.values and arc != "radius":
            self._findings.add(line, "unused-word", f"{function} takes no radius R")
        if motion == "line":
            block.codes["motion"] = "line"
        else:
            block.codes["motion"] = "counter-clockwise arc" if sense == "+" else "clockwise arc"
            if not sense and motion == "circle" and not self._signed(block):
                self._findings.add(line, "arc-form", "a circle without its sense", "", "DR+ or DR-")
        block.arc = arc
        fast = block.names.pop("fast", "")
        if fast and motion == "line":
            block.codes["motion"] = "rapid"
            if arc == "":
                block.arc = "rapid"
        elif fast:
            self._findings.add(line, "feed", "a circle at FMAX")
        return [block]

    @staticmethod
    def _signed(block: Block) -> bool:
        """Whether the sign of an incremental angle says the sense, which it then sets."""
        if not block.relative.get("PA"):
            return False
        if block.value("PA") > 0.0:
            block.codes["motion"] = "counter-clockwise arc"
        return True

    def _centre(self, line: int, words: str) -> None:
        state = self._state
        block = self._words(line, words)
        parts = {"X": state.at.real, "Y": state.at.imag}
        for axis, number in block.values.items():
            if axis not in parts:
                self._findings.add(line, "unused-word", f"CC takes no word {axis}")
                continue
            base = parts[axis] if block.relative.get(axis) else 0.0
            parts[axis] = base + number.value * state.scale
        state.pole = complex(parts["X"], parts["Y"])

    def _words(self, line: int, text: str) -> Block:
        """The words of a path function; what cannot be read of them is found."""
        block = Block(line)
        at, end = 0, len(text.rstrip())
        while at < end:
            found = WORD.match(text, at)
            if found is None:
                self._refuse(line, text[at:].strip())
                block.broken = True
                break
            at = found.end()
            if found["sense"]:
                block.names["sense"] = found["sense"][-1]
            elif found["side"]:
                self._compensate(block, found["side"])
            elif found["fast"]:
                block.names["fast"] = "FMAX"
            elif found["auto"]:
                self._feed_of_tool(block)
            else:
                self._word(block, found["letter"], found["number"])
        return block

    def _feed_of_tool(self, block: Block) -> None:
        """F AUTO: the feed that TOOL CALL states."""
        if self._tool_feed is None:
            what = "F AUTO without a feed F in TOOL CALL"
            self._findings.add(block.line, "missing-word", what, allowed="TOOL CALL n Z S F")
        else:
            block.values["F"] = self._tool_feed

    def _compensate(self, block: Block, side: str) -> None:
        """R0, RL or RR: each block repeats what is active."""
        meaning = SIDES[side]
        if meaning != (self._state.mode("compensation") or "compensation off"):
            block.codes["compensation"], block.words["compensation"] = meaning, side

    def _word(self, block: Block, letter: str, text: str) -> None:
        value = number_of(text)
        if value is None:
            what = f"the number {text[:40]} cannot be one of a program"
            self._findings.add(block.line, "number", what)
            return
        if letter == "M":
            word = normal("M", text)
            for each in COMBINED.get(word, (word,)):
                code(block, each, self._controller, self._findings)
            return
        name = letter.removeprefix("I") if letter != "I" else letter
        if name in block.values:
            self._findings.add(block.line, "repeated-word", f"the word {name} is there twice")
            return
        if letter.startswith("I"):
            block.relative[name] = True
        elif name in ("X", "Y", "Z", "PA"):
            block.relative[name] = False
        block.values[name] = Number(value, text)
        within_reach(block, name, block.values[name], self._controller, self._findings)

    def _refuse(self, line: int, text: str) -> None:
        unread = UNREAD.match(text)
        if not (unread and unread[1] in STILL):
            self._state.lose()
        if unread:
            what = f"{unread[1]} is outside what is read"
            self._findings.add(line, "unsupported", what, shown(text))
        else:
            self._findings.add(line, "unreadable", "cannot be read", shown(text))
