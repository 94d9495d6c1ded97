"""Short programs at random: what the interpreter says of them, and what the controls' own do.

    python -m tests.draws.programs [--count N] [--seed HEX] [--rows FILE] [--control NAME]

Each program begins well; then come blocks of all kinds, right ones, words thrown together, and
damaged texts. LinuxCNC's interpreter (`tests/judges/rs274.py`) and Grbl's parser
(`tests/judges/grbl.py`) run it up to the block that they refuse, and so must we: the same block, or
none, and up to there the same path at the same feed. Where we say that something is outside what
is read, no more is compared. A control that is not there is named, and left out.
"""

from __future__ import annotations

import math
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from random import Random
from typing import Final

from camgeo.milling.machine import load
from camgeo_export.interpreter.moves import ProgramRun
from camgeo_export.interpreter.run import run
from tests.draws.run import Case, parser_of, run_cases
from tests.judges import grbl, rs274
from tests.judges.paths import Leg, difference

REFUSED: Final = frozenset(
    {
        *("unreadable", "unknown-word", "repeated-word", "conflict", "missing-word", "unused-word"),
        *("number", "comment", "no-motion", "plane", "no-arc", "arc-radius", "no-feed"),
        *("compensation", "gouge", "line-length", "line-number", "characters", "no-end"),
    }
)
"""Rules that say that a control does not run a block; the others warn."""

UNREAD: Final = frozenset(("unsupported", "unknown-position"))
"""Rules that say that camgeo does not know where a block goes: it does not read what it needs, or
the control alone knows, as it does the length of the tool that G49 takes back.
"""

NEAR: Final = {"linuxcnc": 1e-6, "grbl": 2e-2}
"""How far paths may differ [mm] and feeds [mm/min]; Grbl computes in single precision, which
counts most in the centre of an arc by its radius."""

INCH: Final = 25.4

AXES: Final = "XYZ"

PLANES: Final = {17: (0, 1), 18: (2, 0), 19: (1, 2)}
"""By the number of its G word, the axes of a plane by their places in XYZ."""

SOUP: Final = {
    "linuxcnc": "G0 G1 G2 G3 G4 G17 G18 G19 G20 G21 G28 G30 G40 G43 G49 G53 G54 G61 G64 G80 G81 G85"
    " G90 G91 G91.1 G94 G98 G99 M0 M1 M3 M5 M6 M7 M8 M9 G7.5 G12 M18",
    "grbl": "G0 G1 G2 G3 G4 G17 G18 G19 G20 G21 G28 G30 G40 G43 G49 G53 G54 G61 G80"
    " G90 G91 G91.1 G94 M0 M1 M3 M5 M7 M8 M9 G64 M6 G12",
}
"""Words that are thrown together."""

LETTERS: Final = {"linuxcnc": "XYZIJKRPQLFSTHDN", "grbl": "XYZIJKRPFSN"}

OFF: Final = (0.001, 0.004, 0.02, 0.1, 0.6, 3.0)
"""By how much the ends of some arcs are off their circle [mm]."""

DAMAGES: Final = (
    "G1 X", "G1 X1.2.3", "G1 X+.5", "G1 X5.", "g1 x 1 . 5", "G 1 X 2", "G01 X02.0", "*",
    "G1 X1 N7", "N7 G1 X1", "N7 N8 G1 X1", ":1000", "%", "% x", "()", "(a (b))", "G1 X1 (open",
    "G1 X1 ) Y2", "G1 X1 ; rest", "(a;b)", "G1 X1 (a) Y2 (b)", "\t", "G1\tX2", "G1 X1\rY2",
    "G1 X1\rG1 X2", "G1 X1 E", "G1 X1 F-5", "S-3", "T-1", "G-1 X1", "M-3", "G1 X1 X2", "G4",
    "G4 X1", "G4 F1", "G4 P1", "G4 P0.5 X3", "G4 U1", "G80 X1", "G80 G0 X1", "G0 G80 X1", "G80",
    "G2", "G2 I5", "I5", "R5", "G3 Z-3 I5", "G2 X5", "G2 X5 R", "G53", "G0 G53", "G53 G0 Z9",
    "G53 X1", "G28", "G91 G28 Z0", "G0 G28 Z0", "G28 G30", "G4 P1 G53 G0 X1",
    "G20 F10", "G21 F250", "G20 G21", "G94", "G94 F300", "M3 M5", "M8 M9", "M7 M8", "M6",
    "G1 X1 M5", "G1.05 X1", "G1.5 X1", "G17 G18", "G90 G91", "D1", "H1", "L2", "Q1", "P1", "K1",
    "G1 X1 P1", "G1 X1 I1", "G1 X1 R1", "G81 X1 Y1 Z-1", "G81 X1 Y1 R1", "G81 Z-1 R1",
    "G81 X1 Z3 R1", "G81 X1 Z-1 R1 L0", "G81 X1 Z-1 R1 Q1", "G81", "X1 Y1",
)  # fmt: skip
"""Blocks right and wrong, as they are."""


class Writer:
    """Writes a program, and knows where it is as long as its blocks are right.

    Attributes
    ----------
    lines : so far.
    """

    def __init__(self, rng: Random, control: str) -> None:
        self.rng = rng
        self.control = control
        self.lines: list[str] = []
        self.at = [0.0, 0.0, 5.0]  # mm
        self.unit, self.plane = 1.0, 17
        self.incremental = self.absolute_centres = False

    def put(self, *words: str, note: bool = True) -> None:
        """A line of some words, with its number in a comment, by which a refusal finds it."""
        self.lines.append(" ".join(words) + (f" ({len(self.lines)})" if note else ""))

    def number(self, value: float) -> str:
        return f"{value / self.unit:.5f}"

    def to(self, target: Sequence[float], axes: Sequence[int]) -> list[str]:
        """The words that lead to a target [mm] along some axes, and the position as printed."""
        words = []
        for axis in axes:
            base = self.at[axis] if self.incremental else 0.0
            text = self.number(target[axis] - base)
            words.append(AXES[axis] + text)
            self.at[axis] = base + float(text) * self.unit
        return words

    def place(self) -> list[float]:
        return [round(self.rng.uniform(-30.0, 30.0), 2) for _ in AXES]

    # -- blocks -----------------------------------------------------------------------------------

    def straight(self) -> None:
        """A line or a traverse, along some axes."""
        axes = self.rng.sample(range(3), self.rng.randint(1, 3))
        feed = [f"F{self.rng.choice((5, 20, 300, 300.5))}"] if self.rng.random() < 0.2 else []
        self.put(self.rng.choice(("G0", "G1", "G01")), *self.to(self.place(), axes), *feed)

    def arc(self) -> None:
        """An arc in the plane: by its centre or its radius, good, or off by a little."""
        rng, (one, two) = self.rng, PLANES[self.plane]
        start = complex(self.at[one], self.at[two])
        target = self.place()
        end = complex(target[one], target[two])
        off = rng.choice((0.0,) * 24 + OFF) * rng.choice((1, -1))
        circle = rng.random() < 0.15
        end = start if circle else end
        arm = 0.5 * (end - start) * (1.0 + 1j * math.tan(rng.uniform(-1.4, 1.4)))
        arm = complex(rng.uniform(-9, 9), rng.uniform(-9, 9)) if circle else arm
        radius = max(0.5 * abs(end - start), abs(arm) if rng.random() < 0.7 else 0.0)
        way = end - start - arm
        end += off * (way / abs(way)) if way and not circle else 0.0
        target[one], target[two] = end.real, end.imag
        across = [3 - one - two] if rng.random() < 0.2 else []
        axes = across if circle and rng.random() < 0.5 else [one, two, *across]
        words = self.to(target, axes)
        if rng.random() < 0.25 and not circle:
            # Half a turn is refused or not by the rounding of single precision.
            radius += 1e-3 * (self.control == "grbl")
            size = (radius + rng.choice((*(0.0,) * 12, 0.0005, 0.01, -0.0005, -0.01))) / self.unit
            words.append(f"R{rng.choice((1, 1, -1)) * size:.5f}")
        else:
            base = start if self.absolute_centres else 0j
            centre = arm + base
            arms = ["IJK"[axis] for axis in (one, two)]
            words += [
                f"{arms[0]}{self.number(centre.real)}",
                f"{arms[1]}{self.number(centre.imag)}",
            ]
        if rng.random() < 0.04:
            words.append(rng.choice(("P1", "P2", "P3", "P1.5", "P0", "I1", "J2", "K3", "R9")))
        self.put(rng.choice(("G2", "G3", "G02")), *words)

    def mode(self) -> None:
        """A word that switches, mostly alone."""
        rng, linuxcnc = self.rng, self.control == "linuxcnc"
        chance = rng.randrange(9)
        if chance == 0:
            self.incremental = not self.incremental
            self.put("G91" if self.incremental else "G90")
        elif chance == 1:
            self.unit = INCH + 1.0 - self.unit
            self.put("G20" if self.unit > 1.0 else "G21", *rng.choice((["F30"], [])))
        elif chance == 2:
            self.plane = rng.choice((17, 18, 19))
            self.put(f"G{self.plane}")
        elif chance == 3 and linuxcnc:
            self.absolute_centres = not self.absolute_centres
            self.put("G90.1" if self.absolute_centres else "G91.1")
        elif chance == 4:
            self.put("G94", *rng.choice((["F200"], [])))
        elif chance == 5 and linuxcnc:
            self.put("T1 M6")
            self.put("G43 H1")
            self.stated()
        elif chance == 6 and linuxcnc:
            self.put(rng.choice(("G61", "G64", "G64 P0.01", "G64 P0.01 Q0.02", "G98", "G99")))
        elif chance == 7:
            self.put(rng.choice(("G28", "G30", "G55", "G54")))
            self.stated()
        else:
            self.put(
                rng.choice(("S500 M3", "M5", "M8", "M9", "G40", "G49", "F120", "G4 P0.2", "M0"))
            )

    def stated(self) -> None:
        """Go to a place that is stated whole."""
        self.incremental = False
        self.put("G90 G0", *self.to(self.place(), range(3)))

    def holes(self) -> None:
        """A cycle of holes, and some more of them."""
        rng = self.rng
        words = self.to(self.place(), rng.choice(([0, 1], [0], [1])))
        top, deep = rng.choice((2.0, 8.0, 40.0)), rng.choice((-3.0, 1.0))
        more = rng.choice(([], [], ["L2"]))
        depth = [f"Z{self.number(deep)}", f"R{self.number(top)}"]
        self.put(rng.choice(("G81", "G85", "G98 G81", "G99 G81")), *words, *depth, *more)
        for _ in range(rng.randint(0, 2)):
            self.put(*self.to(self.place(), [rng.randrange(2)]))
        if rng.random() < 0.7:
            self.put("G80")
        self.stated()

    def compensated(self) -> None:
        """A move under compensation, and what may not be there."""
        if self.plane != 17:
            self.plane = 17
            self.put("G17")
        self.stated()
        self.at[0] += 40.0
        self.put(
            self.rng.choice(("G41 D1 G1", "G42 D1 G1", "G41.1 D2 G1")), *self.here("X"), "F200"
        )
        self.put(
            self.rng.choice(
                ("G43 H1", "G49", "G54", "G55", "G61", "G64 P0.01", "G17", "G18", "T1 M6", "G28",
                 "G53 G0 X1", "G41 D1", "G81 X1 Y1 Z-1 R2", "G94 F100", "M8", "F99", "G91.1", "")
            )
        )  # fmt: skip
        self.at[0] += 30.0
        self.put("G1", *self.here("X"))
        self.at[0] += 30.0
        self.put("G40 G1", *self.here("X"))
        self.stated()

    def here(self, axes: str) -> list[str]:
        """Words of where it is, absolute."""
        return [axis + self.number(self.at[AXES.index(axis)]) for axis in axes]

    def soup(self) -> None:
        """Words thrown together."""
        rng = self.rng
        words = rng.sample(SOUP[self.control].split(), rng.randint(0, 2))
        for letter in rng.sample(LETTERS[self.control], rng.randint(0, 3)):
            value = rng.choice((0, 1, 2, 1, 2.5, 7, -3, 30))
            words.append(f"{letter}{1 if letter in 'TDHN' else value}")
        if rng.random() < 0.3:
            rng.shuffle(words)
        self.put(*words)
        self.recover(words)

    def damage(self) -> None:
        """A block that is right or wrong as it stands."""
        chance = self.rng.random()
        if chance < 0.06:
            size = self.rng.randint(74, 84) if chance < 0.03 else self.rng.randint(248, 258)
            text = "G1 X1" + " " * (size - 7) + "Y2" if chance < 0.02 else "G1 X1 ("
            self.put(text + "x" * (size - len(text) - 1) + ")" * ("(" in text), note=False)
        else:
            block = self.rng.choice(DAMAGES)
            self.put(block, note=block not in ("%", "% x", "*", ":1000", "G1 X1 (open"))
        self.recover(self.lines[-1].upper().split())

    def recover(self, words: list[str]) -> None:
        """State what may have changed."""
        self.unit, self.plane, self.incremental = 1.0, 17, False
        self.put("G17 G21 G90", *(["G40"] if "G40" in words else []))
        self.put("F300")
        self.stated()


def program(rng: Random, control: str) -> str:
    """A program of a few blocks, mostly right up to a damage."""
    writer = Writer(rng, control)
    more = " G43 H1" if control == "linuxcnc" else ""
    start = ["%"] if control == "linuxcnc" and rng.random() < 0.15 else []
    writer.lines = [*start, "G17 G21 G40 G49 G80 G90 G94 (head)"]
    if control == "linuxcnc":
        writer.lines += ["T1 M6", "G98" + more]
    writer.lines += ["S1000 M3", "G0 X0 Y0 Z5", "F300"]
    kinds: list[Callable[[], None]] = [writer.straight, writer.arc, writer.mode]
    rare: list[Callable[[], None]] = [writer.soup, writer.damage]
    if control == "linuxcnc":
        rare += [writer.holes, writer.compensated]
    share = rng.choice((0.0, 0.1, 0.3))
    for _ in range(rng.randint(3, 14)):
        rng.choice(rare if rng.random() < share else kinds)()
    end = rng.choice((["M2"], ["M30"], ["M2", "%"], ["%"], [])) if rng.random() < 0.1 else ["M2"]
    mark = "\N{BYTE ORDER MARK}" if rng.random() < 0.01 else ""
    return mark + "\n".join([*writer.lines, *end, ""])


# -- verdicts -------------------------------------------------------------------------------------

Verdict = tuple[int | None, str, list[Leg]]
"""Line that is refused, 0 for the whole, None for none; what is said of it; the moves."""


def of_linuxcnc(text: str) -> Verdict:
    """What LinuxCNC's interpreter makes of a program."""
    legs, _ = rs274.run(text)
    said = rs274.refusal(text)
    if said is None:
        return None, "", legs
    message, block = said
    if message.startswith("File ended"):
        return 0, message, legs
    wanted = "".join(block.split())
    lines = [number for number, line in enumerate(text.split("\n"), start=1)
             if "".join(line.split())[:200] == wanted[:200]]  # fmt: skip
    return (lines[0] if lines else -1), f"{message}: {block}", legs


def of_grbl(text: str) -> Verdict:
    """What Grbl's parser makes of a program, which it does not stop at an error."""
    legs, errors = grbl.run(text)
    if not errors:
        return None, "", legs
    return int(errors[0].split()[1].rstrip(":")), errors[0], legs


CONTROLS: Final[dict[str, tuple[Callable[[], str], Callable[[str], Verdict]]]] = {
    "linuxcnc": (rs274.absent, of_linuxcnc),
    "grbl": (grbl.PARSER.absent, of_grbl),
}
"""By profile: why a control is not there, and what it makes of a program."""


def ours(found: ProgramRun, control: str) -> tuple[int | None, str, int | None]:
    """The line that we say is refused, why, and the first that is not supported."""
    by_line = sorted(found.findings, key=lambda each: each.line or math.inf)
    unread = next((each.line for each in by_line if each.rule in UNREAD), None)
    for each in by_line:
        ends = each.rule == "no-end" and (each.line or control == "grbl")
        if each.rule in REFUSED and not ends:
            return each.line, f"{each.rule}: {each}", unread
    return None, "", unread


def compared(text: str, control: str) -> tuple[str, str]:
    """What we say of a program otherwise than the control, empty if nothing; and whether it is
    "refused", "run", or not read to its end, "unread".
    """
    refused, said, legs = CONTROLS[control][1](text)
    found = run(text.encode(), load(control), most=10_000)
    line, why, unread = ours(found, control)
    became = "unread" if unread is not None else "run" if refused is None else "refused"
    last = min(math.inf if each in (None, 0) else each for each in (refused, line, unread))
    if (refused, line) != (None, None) and refused != line:
        first = min(math.inf if each in (None, 0) else each for each in (refused, line))
        if unread is None or first < unread:
            return f"refused: line {refused} ({said}), ours {line} ({why})", became
    # Under compensation, and in the move that leaves it, the control's path is the cutter's.
    beside = {move.line for move in found.moves if move.compensation}
    pairs = zip(found.moves, found.moves[1:], strict=False)
    beside |= {after.line for before, after in pairs if before.compensation}
    kept = [move for move in found.moves if move.line < last and move.line not in beside]
    rest = [leg for leg in legs if leg.line < last and leg.line not in beside]
    try:
        apart = difference(replace(found, moves=tuple(kept)), rest)
    except AssertionError as error:
        return f"path: {error}", became
    return (f"path: {apart:.3g} mm or mm/min apart" if apart > NEAR[control] else ""), became


def judged(asked: Namespace) -> Iterator[Case]:
    """The programs for each control that is there; a miss has the program."""
    for control, (absent, _) in CONTROLS.items():
        if asked.control not in (None, control):
            continue
        if reason := absent():
            sys.stdout.write(f"{control} left out: {reason}\n")
            continue
        rng = Random(asked.seed)
        for number in range(asked.count):
            text = program(Random(rng.getrandbits(64)), control)
            found, became = compared(text, control)
            yield f"{control} {number}, {became}", [f"{found}\n{text}"] if found else []


if __name__ == "__main__":
    parser = parser_of(__doc__, 1000)
    parser.add_argument("--control", choices=CONTROLS, help="only this one")
    sys.exit(run_cases(parser, judged))
