"""Interpreter of milling programs, as a controller would run them: words, modal state, moves.

It knows the words that our machine profiles use and rejects others, so that nothing is overlooked.
"""

from __future__ import annotations

import cmath
import math
import re
from dataclasses import dataclass, field

from camgeo.numeric.arrays import phase
from camgeo.reading import (
    COORDINATE,
    DIGITS,
    PATHS,
    PROGRAM,
    beyond,
    check_text,
    lines_of,
    number_of,
)
from camgeo.wording import counted
from camgeo_export.errors import FileError
from camgeo_export.gcode.moves import CutterMove, Kind, Loop, loop_of, nearly_closed

WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
"""A comment in brackets, or one up to the end of the line."""

MOTIONS = (0, 1, 2, 3)

LETTERS = "FGHIJMNPQSTXYZ"
"""Of the words that our programs use, and N."""

MODAL = {17, 40, 43, 49, 54, 80, 90, 91.1, 94}
"""G words that must be active before the first cut; G49 is superseded by G43."""

TOOL_LENGTH = 43

UNITS = {20: 25.4, 21: 1.0}


@dataclass(frozen=True, slots=True)
class Stop:
    """A change of the tool, or a stop of the spindle or the program.

    Attributes
    ----------
    code : of its M word.
    z : height [mm] at which it happens; NaN before the first move along Z.
    line : in the file, counted from 1.
    """

    code: int
    z: float
    line: int


@dataclass(frozen=True, slots=True)
class Program:
    """A program that was run.

    Attributes
    ----------
    mm_per_unit : of the program's unit of length.
    step : last printed decimal [mm].
    blending, naive_cam : P and Q of G64 [mm]; 0 for the exact path.
    moves : in the order of running.
    comments : without brackets.
    stops : in the order of running.
    """

    mm_per_unit: float
    step: float
    blending: float
    naive_cam: float
    moves: tuple[CutterMove, ...]
    comments: tuple[str, ...]
    stops: tuple[Stop, ...]

    def loops(self, gap: float = 0.0) -> list[Loop]:
        """Closed runs of cuts at constant height; leads into and out of them are omitted.

        A run that ends up to `gap` [mm] from where it began is closed, too; its mismatch is larger
        by that.
        """
        found: list[Loop] = []
        run: list[CutterMove] = []
        # A point already visited closes a loop; the search then starts again, so that a path which
        # overlaps its beginning is found once, and no loop contains another.
        reached: dict[complex, int] = {}
        for move in self.moves:
            flat = move.kind != "rapid" and move.z_start == move.z_end
            if not flat or (run and run[-1].operation != move.operation):
                found += nearly_closed(run, gap)
                run, reached = [], {}
            if not flat:
                continue
            reached[move.start] = len(run)
            run.append(move)
            if len(found) > PATHS:
                raise beyond("the program", counted(len(found), "closed path"), PATHS, PROGRAM)
            if move.end in reached:
                found.append(loop_of(run[reached[move.end] :], 0.0))
                run, reached = [], {}
        return found + nearly_closed(run, gap)

    def verify(self, safe_height: float, radius_tolerance: float) -> None:
        """Raise FileError at the first move that is unsafe or that a controller may reject.

        Traverses must stay at `safe_height` [mm] or above in the plane and out of the material;
        cuts need feed and spindle on; radii of an arc may differ by `radius_tolerance` [mm]. Tools
        must be changed, and the spindle stopped, at `safe_height` or above.
        """
        height = safe_height - 0.5 * self.step
        for move in self.moves:
            fault = _fault(move, height, radius_tolerance)
            if fault:
                raise FileError(f"line {move.line}: {fault}")
        for stop in self.stops:
            if stop.z < height:
                where = f"at Z {stop.z:g} mm, below the safe height"
                raise FileError(f"line {stop.line}: M{stop.code} {where}")


@dataclass(slots=True)
class _State:
    """Modal state of the controller."""

    scale: float = math.nan
    motion: int = -1
    at: complex = complex(math.nan, math.nan)
    z: float = math.nan
    feed: float = 0.0
    spindle: bool = False
    speed: float = 0.0
    operation: str = ""
    tool: int = 0
    offset: int = 0
    chosen: int = 0
    active: frozenset[float] = frozenset()
    blending: float = math.inf
    naive_cam: float = math.inf
    step: float = math.inf
    ended: bool = False
    stops: list[Stop] = field(default_factory=list)


def read(text: str) -> Program:
    """Run a program; raises FileError at an invalid block."""
    data = text.encode("ascii", "replace")
    check_text(data, PROGRAM, "the program")
    state = _State()
    moves: list[CutterMove] = []
    comments: list[str] = []
    for number, line in enumerate(lines_of(data, "ascii"), start=1):
        for note in notes_of(line):
            comments.append(note)
            if note.startswith("operation "):
                state.operation = note.removeprefix("operation ")
        block = COMMENT.sub("", line).strip().upper()
        if not block or block == "%":
            continue
        if state.ended:
            raise FileError(f"line {number}: block after the end of the program")
        if WORD.sub("", block).strip():
            raise FileError(f"line {number}: cannot be read: {block}")
        words = WORD.findall(block)
        wrong = next((letter + value for letter, value in words if number_of(value) is None), "")
        if wrong:
            message = f"the word {wrong[:40]} has more than {DIGITS} digits or is beyond"
            raise FileError(f"line {number}: {message} {COORDINATE:g}")
        move = _run(state, words, number)
        if move is not None:
            moves.append(move)
    if not state.ended or state.spindle:
        raise FileError("the program does not end with the spindle off and M2 or M30")
    return Program(
        state.scale,
        state.step,
        state.blending,
        state.naive_cam,
        tuple(moves),
        tuple(comments),
        tuple(state.stops),
    )


def notes_of(text: str) -> list[str]:
    """The comments in `text`, without brackets."""
    return [(inside or after).strip() for inside, after in COMMENT.findall(text)]


def _run(state: _State, words: list[tuple[str, str]], line: int) -> CutterMove | None:
    """Run one block; return its move, if any."""
    letters = [letter for letter, _ in words]
    for letter in letters:
        if letter not in LETTERS:
            raise FileError(f"line {line}: the word {letter} is not expected in camgeo's programs")
        if letter not in "GM" and letters.count(letter) > 1:
            raise FileError(f"line {line}: the word {letter} appears twice")
    codes = [float(value) for letter, value in words if letter == "G"]
    if sum(code in MOTIONS for code in codes) > 1:
        raise FileError(f"line {line}: two kinds of motion in one block")
    values = {letter: float(value) for letter, value in words if letter not in "GM"}
    for code in codes:
        _g(state, code, values, line)
    if "F" in values:
        state.feed = values["F"] * state.scale
    state.chosen = int(values.get("T", state.chosen))
    state.speed = values.get("S", state.speed)
    for code in (float(value) for letter, value in words if letter == "M"):
        _m(state, code, line)
    if not values.keys() & {"X", "Y", "Z", "I", "J"}:
        return None
    for letter, value in words:
        if letter in "XYZ":
            places = len(value.partition(".")[2])
            state.step = min(state.step, 10.0**-places * state.scale)
    return _move(state, values, line)


def _g(state: _State, code: float, values: dict[str, float], line: int) -> None:
    if code in MOTIONS:
        state.motion = int(code)
    elif code in UNITS:
        state.scale = UNITS[int(code)]
    elif code == 61:
        state.blending = state.naive_cam = 0.0
    elif code == 64:
        # Without P the controller keeps its speed at any deviation; without Q, Q is P.
        state.blending = values.get("P", math.inf) * state.scale
        state.naive_cam = values.get("Q", values.get("P", math.inf)) * state.scale
    elif code in MODAL:
        state.active |= {code}
        if code == TOOL_LENGTH:  # without H that of the tool in the spindle
            state.offset = int(values.get("H", state.tool))
    else:
        raise FileError(f"line {line}: G{code:g} is not expected in camgeo's programs")


def _m(state: _State, code: float, line: int) -> None:
    if code == 3:
        state.spindle = True
        return
    if code == 5:
        state.spindle = False
    elif code in (2, 30):
        state.ended = True
    elif code == 6:  # controllers stop the spindle for it
        state.tool, state.spindle = state.chosen, False
    else:
        raise FileError(f"line {line}: M{code:g} is not expected in camgeo's programs")
    state.stops.append(Stop(int(code), state.z, line))


def _move(state: _State, values: dict[str, float], line: int) -> CutterMove:
    if state.motion < 0 or math.isnan(state.scale):
        raise FileError(f"line {line}: move before unit and kind of motion are known")
    missing = MODAL - state.active
    if state.motion > 0 and missing:
        raise FileError(f"line {line}: cut without G{min(missing):g}")
    start, z_start = state.at, state.z
    scale = state.scale
    x = values["X"] * scale if "X" in values else start.real
    y = values["Y"] * scale if "Y" in values else start.imag
    end = complex(x, y)
    z_end = values["Z"] * scale if "Z" in values else z_start
    kind: Kind = "rapid" if state.motion == 0 else "line"
    centre, sweep, mismatch = 0j, 0.0, 0.0
    if state.motion > 1:
        kind = "arc"
        arm = complex(values.get("I", 0.0), values.get("J", 0.0)) * scale
        centre = start + arm
        if not arm or end in (start, centre) or z_end != z_start:
            raise FileError(f"line {line}: not an arc in the plane")
        mismatch = abs(abs(arm) - abs(end - centre))
        sweep = phase((end - centre) / -arm) % (2.0 * math.pi)
        sweep -= 2.0 * math.pi if state.motion == 2 else 0.0
    state.at, state.z = end, z_end
    feed = 0.0 if kind == "rapid" else state.feed
    speed = state.speed if state.spindle else 0.0
    return CutterMove(
        kind, start, end, z_start, z_end, centre, sweep, mismatch, feed, speed,
        state.operation, state.tool, state.offset, line,
    )  # fmt: skip


def _fault(move: CutterMove, height: float, radius_tolerance: float) -> str:
    """What is wrong with a move; empty if nothing."""
    if move.kind == "rapid":
        low = min(move.z_start, move.z_end)
        if move.end != move.start and not cmath.isnan(move.end) and not low >= height:
            return f"traverse in the plane at Z {low:g} mm, below the safe height"
        if move.z_end < 0.0:
            return f"traverse down to Z {move.z_end:g} mm, into the material"
        return ""
    if cmath.isnan(move.start) or math.isnan(move.z_start):
        return "cut from an unknown position"
    if not move.feed > 0.0 or not move.speed > 0.0:
        return "cut without feed, or with the spindle off"
    if move.mismatch > radius_tolerance:
        return f"the radii of the arc differ by {move.mismatch:g} mm"
    return ""
