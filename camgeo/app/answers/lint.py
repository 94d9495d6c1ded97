"""What `camgeo lint` finds: programs run as the controller of a machine profile would run them."""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import entry_points
from itertools import groupby
from pathlib import Path
from typing import Any, Final, Literal, Protocol

from camgeo.app.answers.answer import BROKEN, FINE, WRONG, Answer, Key
from camgeo.app.cli.command import Argument, CallError, number, opened, show
from camgeo.design.design import Design
from camgeo.design.linting import LineFinding, Linted, WorkData
from camgeo.design.product import Product, find_disc, product_sides
from camgeo.errors import Fault, FileError, SceneError, unreadable
from camgeo.milling.machine import Machine, load
from camgeo.reading import PROGRAM, read_within
from camgeo.scene.scene import Scene
from camgeo.units import LengthUnit, counted, in_unit, shortened


@dataclass(frozen=True, slots=True)
class Placed:
    """A finding with the line that it concerns.

    Attributes
    ----------
    found : the finding.
    text : of the line; empty if it concerns the whole program.
    """

    found: LineFinding
    text: str

    @property
    def line(self) -> int | None:
        """Its number; None if it concerns the whole program."""
        return self.found.line or None


@dataclass(frozen=True, slots=True)
class Program:
    """One file.

    Attributes
    ----------
    path : of the file.
    damage : why it cannot be read; empty if it can.
    found : what was found in it; None if it cannot be read.
    """

    path: Path
    damage: str = ""
    found: Linted | None = None

    @property
    def file(self) -> str:
        """Its path, as text."""
        return str(self.path)

    @property
    def moves(self) -> int:
        return 0 if self.found is None else self.found.moves

    @property
    def complete(self) -> bool:
        return self.found is not None and self.found.complete

    @property
    def findings(self) -> tuple[Placed, ...]:
        """By line, those of the whole program last."""
        found = self.found
        if found is None:
            return ()
        return tuple(Placed(each, found.texts.get(each.line, "")) for each in found.findings)


@dataclass(frozen=True, slots=True)
class Lint(Answer):
    """Programs, and what was found in them.

    Attributes
    ----------
    machine : profile that they were read with.
    bench : what was taken of the work.
    programs : one per file.
    scene : with tools, blank and holding; None without one.
    """

    machine: Machine
    bench: WorkData
    programs: tuple[Program, ...]
    scene: Scene | None = None

    @property
    def clean(self) -> bool:
        """Whether all files could be read and nothing was found in any."""
        return all(each.found is not None and not each.findings for each in self.programs)

    @property
    def exit_code(self) -> int:
        """2 if a file cannot be read, 1 if something was found, else 0."""
        if any(each.damage for each in self.programs):
            return WRONG
        return FINE if self.clean else BROKEN


def lint(
    paths: Sequence[Path],
    machine: str,
    bench: WorkData | None = None,
    design: Design | None = None,
    *,
    second_side: bool = False,
) -> Lint:
    """Run programs, and find what is wrong with them.

    Parameters
    ----------
    paths : of the files.
    machine : name of a machine profile, or the path of one.
    bench : what the programs do not say of the work; by default Z 0 is the top of the stock.
    design : whose tools, blank and holding they are run with; None if that is not to be judged.
    second_side : whether they mill the second side of it; else they say so in a comment.

    Raises
    ------
    SceneError
        If there is no such profile, or it is wrong; if the scene's own program cannot be planned.
    """
    profile, work = load(machine, "machine"), bench or WorkData()
    runs: Linter = _installed("camgeo.linters", "interpreter")
    if design is not None and not design.scene.states_milling:
        fault = Fault("tool", "", "is not stated: nothing is known of the work")
        raise SceneError([fault], design.scene.source.file)
    if second_side and design is not None and len(product_sides(design.disc)) == 1:
        raise SceneError([Fault("second_side", "", "is not stated")], design.scene.source.file)

    def of(path: Path) -> Product | None:
        """What a program mills."""
        if design is None:
            return None
        disc = find_disc(design.discs, path.stem)
        return product_sides(disc)[-1] if second_side else disc

    found = tuple(_program(path, profile, work, runs, of(path)) for path in paths)
    return Lint(profile, work, found, None if design is None else design.scene)


class Linter(Protocol):
    """Runs programs; registered as the entry point `gcode` of the group ``camgeo.linters``."""

    def lint(self, data: bytes, machine: Machine, bench: WorkData) -> Linted:
        """All findings; FileError for data beyond the limits of a program."""


class WorkJudge(Protocol):
    """Says what programs do to the blank and the part of a scene."""

    def worked(self, product: Product, data: bytes, machine: Machine) -> tuple[LineFinding, ...]:
        """Findings on the work, by line."""


def _installed(group: str, what: str) -> Any:
    """What is registered for programs in a group of entry points; FileError if nothing is."""
    found = entry_points(group=group, name="gcode")
    if not found:
        raise FileError(f"the {what} of programs is not installed: install camgeo again")
    return next(iter(found)).load()


def _program(
    path: Path, machine: Machine, bench: WorkData, runs: Linter, product: Product | None
) -> Program:
    try:
        data = read_within(path, PROGRAM)
        found = runs.lint(data, machine, bench)
        if product is not None:
            judge: WorkJudge = _installed("camgeo.verifiers", "verifier")
            found = _with(found, judge.worked(product, data, machine), data)
        return Program(path, found=found)
    except FileError as error:
        return Program(path, str(error))
    except (OSError, ValueError) as error:  # the latter for a path that no file can have
        return Program(path, f"cannot be read: {unreadable(error)}")


def _with(found: Linted, further: tuple[LineFinding, ...], data: bytes) -> Linted:
    """The same with further findings, and the texts of their lines."""
    lines = data.decode("utf-8", "replace").splitlines()
    texts = {each.line: lines[each.line - 1] for each in further if 0 < each.line <= len(lines)}
    both = sorted((*found.findings, *further), key=lambda each: each.line or math.inf)
    return replace(found, findings=tuple(both), texts={**texts, **found.texts})


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


DOCUMENT: Final = Key(
    "Programs run as the controller of a machine profile would run them.",
    {
        "machine": Key(
            "Name of the machine profile that the programs were read with.", of="machine.name"
        ),
        "stock_top_mm": Key("Z of the highest stock.", of="bench.stock_top"),
        "clearance_mm": Key("Z from which on traverses may go anywhere.", of="bench.free"),
        "clean": "Whether all files could be read and nothing was found in any.",
        "programs": Key(
            "In the order in which they were named.",
            {
                "file": "Its path, as named.",
                "refused": Key(
                    "Why it cannot be read; missing if it can.", of="damage", optional=True
                ),
                "moves": "Moves that it makes.",
                "complete": "Whether it was read to its end; false after too many findings.",
                "findings": Key(
                    "By line, those of the whole program last.",
                    {
                        "line": Key(
                            "Line of the file, counted from 1; missing for the whole program.",
                            optional=True,
                        ),
                        "text": "Text of the line.",
                        "rule": Key(
                            "Name of the rule that is broken, as in docs/lint.md.", of="found.rule"
                        ),
                        "concerns": Key(
                            "What it concerns.",
                            of="found.concerns",
                            type=Literal[
                                "words", "path", "form", "safety", "frame", "limits", "work"
                            ],
                        ),
                        "what": Key("What is wrong.", of="found.what"),
                        "value": Key("What was found.", of="found.value", optional=True),
                        "allowed": Key("What would be right.", of="found.allowed", optional=True),
                    },
                ),
            },
        ),
    },
    type=Lint,
)


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo lint` finds, in words.


WIDTH: Final = 100

LONGEST: Final = 80
"""Characters shown of a line of a program."""

INDENT: Final = " " * 12


def text(answer: Lint) -> str:
    """Each file with what was found in it: line, its text, what is wrong, what is allowed."""
    lines: list[str] = []
    unit = "mm" if answer.scene is None else answer.scene.unit
    for program in answer.programs:
        lines += _of(program, answer.machine.name, unit)
    return "\n".join(lines)


def _of(program: Program, machine: str, unit: LengthUnit) -> list[str]:
    if program.damage:
        return [f"{program.path}: cannot be used: {program.damage}"]
    found = program.findings
    count = counted(len(found), "finding") if found else "nothing found"
    lines = [f"{program.path}: {count}, {counted(program.moves, 'move')}, as for {machine}"]
    for _, group in groupby(found, lambda each: each.line):
        placed = list(group)
        lines += [_place(placed[0]), *(line for each in placed for line in _said(each, unit))]
    if not program.complete:
        lines.append("  and perhaps more: the program was not read further")
    return lines


def _place(each: Placed) -> str:
    """The line, and its text."""
    if each.line is None:
        return "  the program"
    return f"  line {each.line:<5} {shortened(each.text.strip(), LONGEST)}".rstrip()


def _said(each: Placed, unit: LengthUnit) -> list[str]:
    """What is wrong in it, in that unit before a line may end between a number and its unit."""
    found = each.found
    said = f"{found.rule}: {found.what}"
    said += f", {found.value}" if found.value else ""
    said += f"; allowed: {found.allowed}" if found.allowed else ""
    return textwrap.wrap(
        in_unit(said, unit), WIDTH, initial_indent=INDENT, subsequent_indent=INDENT + "  "
    )


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo lint part.nc --machine fanuc\n"
    "  camgeo lint *.ngc --machine linuxcnc --stock-top 0 --clearance 5\n"
    "  camgeo lint part.tap --machine my-mill.toml --json\n"
    "  camgeo lint part.ngc --machine linuxcnc --scene part.toml"
)


def _radius(text: str) -> tuple[int, float]:
    offset, mark, radius = text.partition("=")
    if not (mark and offset.isascii() and offset.isdigit() and len(offset) <= 6):
        raise argparse.ArgumentTypeError(f"{text!r} is not an offset and its radius, like 1=3.0")
    return int(offset), number(radius)


ARGUMENTS: Final = (
    Argument("files", metavar="PROGRAM", nargs="+", help="files, of any origin"),
    Argument(
        "--machine",
        metavar="NAME|PROFILE",
        required=True,
        help="machine profile: the name of one, or a TOML file",
    ),
    Argument(
        "--stock-top",
        metavar="MM",
        type=number,
        default=0.0,
        help="Z of the highest stock; default 0",
    ),
    Argument(
        "--clearance",
        metavar="MM",
        type=number,
        help="Z from which on traverses may go anywhere; default: the top of the stock",
    ),
    Argument(
        "--radius",
        metavar="D=MM",
        action="append",
        default=[],
        type=_radius,
        help="what offset D holds, where the control compensates for the cutter: its radius, or its"
        " wear alone",
    ),
    Argument(
        "--scene",
        metavar="SCENE",
        help="scene whose tools, blank, holding and part the programs are run with",
    ),
    Argument(
        "--second-side",
        action="store_true",
        help="the programs mill the second side of the scene; those of camgeo say so themselves",
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Show what was found; 0 for nothing, 1 for something, 2 if a file cannot be read."""
    clearance = arguments.clearance
    if clearance is not None and clearance < arguments.stock_top:
        raise CallError("argument --clearance: is below the top of the stock")
    bench = WorkData(arguments.stock_top, clearance, tuple(arguments.radius))
    paths = [Path(name) for name in arguments.files]
    design = opened(arguments) if arguments.scene is not None else None
    second = arguments.second_side
    if second and design is None:
        raise CallError("argument --second-side: needs --scene, whose second side it is")
    return show(lint(paths, arguments.machine, bench, design, second_side=second), arguments)
