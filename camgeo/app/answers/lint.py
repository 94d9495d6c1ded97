"""Answer of `camgeo lint`: programs run as the controller of a machine profile would run them."""

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
from camgeo.reading import PROGRAM, read_limited
from camgeo.scene.scene import Scene
from camgeo.units import LengthUnit, counted, in_unit, shortened


@dataclass(frozen=True, slots=True)
class Placed:
    """A finding with the line that it concerns.

    Attributes
    ----------
    finding : rule, values and the number of the line.
    text : of the line; empty if the finding concerns the whole program.
    """

    finding: LineFinding
    text: str

    @property
    def line(self) -> int | None:
        """Number of the line, from 1; None if the finding concerns the whole program."""
        return self.finding.line or None


@dataclass(frozen=True, slots=True)
class Program:
    """One file.

    Attributes
    ----------
    path : of the file.
    damage : why it cannot be read; empty if it can.
    linted : the program with its findings; None if it cannot be read.
    """

    path: Path
    damage: str = ""
    linted: Linted | None = None

    @property
    def file(self) -> str:
        """Path of the file, as text."""
        return str(self.path)

    @property
    def moves(self) -> int:
        return 0 if self.linted is None else self.linted.moves

    @property
    def complete(self) -> bool:
        return self.linted is not None and self.linted.complete

    @property
    def findings(self) -> tuple[Placed, ...]:
        """The findings by line, those on the whole program last."""
        linted = self.linted
        if linted is None:
            return ()
        return tuple(
            Placed(finding, linted.texts.get(finding.line, "")) for finding in linted.findings
        )


@dataclass(frozen=True, slots=True)
class Lint(Answer):
    """Programs and the findings on them.

    Attributes
    ----------
    machine : profile with which they were run.
    bench : what was assumed of the setup.
    programs : one per file.
    scene : with tools, blank and holding; None without one.
    """

    machine: Machine
    bench: WorkData
    programs: tuple[Program, ...]
    scene: Scene | None = None

    @property
    def clean(self) -> bool:
        """Whether all files could be read and none has a finding."""
        return all(program.linted is not None and not program.findings for program in self.programs)

    @property
    def exit_code(self) -> int:
        """2 if a file cannot be read, 1 if there is a finding, else 0."""
        if any(program.damage for program in self.programs):
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
    """Run programs, and report what is wrong with them.

    Parameters
    ----------
    paths : of the files.
    machine : name of a machine profile, or the path of one.
    bench : what the programs do not state of the setup; by default Z 0 is the top of the stock.
    design : supplies tools, blank and holding; None if the work is not to be checked.
    second_side : whether they mill the second side of it; programs of camgeo state that in a
        comment.

    Raises
    ------
    SceneError
        If there is no such profile, or it is wrong; if the scene's own program cannot be planned.
    """
    profile, work = load(machine, "machine"), bench or WorkData()
    runs: Linter = _installed("camgeo.linters", "interpreter")
    if design is not None and not design.scene.states_milling:
        fault = Fault("tool", "", "is not stated: nothing is known about the workpiece")
        raise SceneError([fault], design.scene.source.file)
    if second_side and design is not None and len(product_sides(design.disc)) == 1:
        raise SceneError([Fault("second_side", "", "is not stated")], design.scene.source.file)

    def milled_product(path: Path) -> Product | None:
        """The disc that the program mills, by the name of its file; None without a design."""
        if design is None:
            return None
        disc = find_disc(design.discs, path.stem)
        # The second side comes last.
        return product_sides(disc)[-1] if second_side else disc

    programs = tuple(_program(path, profile, work, runs, milled_product(path)) for path in paths)
    return Lint(profile, work, programs, None if design is None else design.scene)


class Linter(Protocol):
    """Runs programs; registered as the entry point `gcode` of the group ``camgeo.linters``."""

    def lint(self, data: bytes, machine: Machine, bench: WorkData) -> Linted:
        """All findings; FileError for data beyond the limits of a program."""


class WorkJudge(Protocol):
    """Checks what programs do to the blank and the part of a scene."""

    def worked(self, product: Product, data: bytes, machine: Machine) -> tuple[LineFinding, ...]:
        """Findings on the workpiece, by line."""


def _installed(group: str, what: str) -> Any:
    """The entry point for programs in a group, loaded; FileError if none is registered."""
    registered = entry_points(group=group, name="gcode")
    if not registered:
        raise FileError(f"the {what} of programs is not installed: install camgeo again")
    return next(iter(registered)).load()


def _program(
    path: Path, machine: Machine, bench: WorkData, runs: Linter, product: Product | None
) -> Program:
    try:
        data = read_limited(path, PROGRAM)
        linted = runs.lint(data, machine, bench)
        if product is not None:
            judge: WorkJudge = _installed("camgeo.verifiers", "verifier")
            linted = _add_findings(linted, judge.worked(product, data, machine), data)
        return Program(path, linted=linted)
    except FileError as error:
        return Program(path, str(error))
    except (OSError, ValueError) as error:  # the latter for a path that no file can have
        return Program(path, f"cannot be read: {unreadable(error)}")


def _add_findings(linted: Linted, further: tuple[LineFinding, ...], data: bytes) -> Linted:
    """The linted program with further findings, and the texts of their lines.

    Findings on the whole program, with line 0, stay last.
    """
    lines = data.decode("utf-8", "replace").splitlines()
    texts = {
        finding.line: lines[finding.line - 1]
        for finding in further
        if 0 < finding.line <= len(lines)
    }
    both = sorted(
        (*linted.findings, *further), key=lambda line_finding: line_finding.line or math.inf
    )
    return replace(linted, findings=tuple(both), texts={**texts, **linted.texts})


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "Programs run as the controller of a machine profile would run them.",
    {
        "machine": Key(
            "Name of the machine profile with which the programs were run.", of="machine.name"
        ),
        "stock_top_mm": Key("Z of the highest stock.", of="bench.stock_top"),
        "clearance_mm": Key("Z from which on traverses may go anywhere.", of="bench.free"),
        "clean": "Whether all files could be read and none has a finding.",
        "programs": Key(
            "The programs, in the order of the call.",
            {
                "file": "Path of the file, as in the call.",
                "refused": Key(
                    "Why it cannot be read; missing if it can.", of="damage", optional=True
                ),
                "moves": "Moves that it makes.",
                "complete": "Whether it was read to its end; false after too many findings.",
                "findings": Key(
                    "The findings by line, those on the whole program last.",
                    {
                        "line": Key(
                            "Line of the file, counted from 1; missing for the whole program.",
                            optional=True,
                        ),
                        "text": "Text of the line.",
                        "rule": Key(
                            "Name of the rule that is broken, as in docs/lint.md.",
                            of="finding.rule",
                        ),
                        "concerns": Key(
                            "What it concerns.",
                            of="finding.concerns",
                            type=Literal[
                                "words", "path", "form", "safety", "frame", "limits", "work"
                            ],
                        ),
                        "what": Key("What is wrong.", of="finding.what"),
                        "value": Key(
                            "The value in the program.", of="finding.value", optional=True
                        ),
                        "allowed": Key("What would be right.", of="finding.allowed", optional=True),
                    },
                ),
            },
        ),
    },
    type=Lint,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo lint` in words.


WIDTH: Final = 100

LONGEST: Final = 80
"""Characters shown of a line of a program."""

INDENT: Final = " " * 12


def text(answer: Lint) -> str:
    """Each file with its findings: the line, its text, what is wrong, what is allowed."""
    lines: list[str] = []
    unit = "mm" if answer.scene is None else answer.scene.unit
    for program in answer.programs:
        lines += _program_lines(program, answer.machine.name, unit)
    return "\n".join(lines)


def _program_lines(program: Program, machine: str, unit: LengthUnit) -> list[str]:
    if program.damage:
        return [f"{program.path}: cannot be used: {program.damage}"]
    findings = program.findings
    count = counted(len(findings), "finding") if findings else "no findings"
    lines = [f"{program.path}: {count}, {counted(program.moves, 'move')}, run as on {machine}"]
    for _, group in groupby(findings, lambda place: place.line):
        placed = list(group)
        lines += [
            _place(placed[0]),
            *(line for finding in placed for line in _finding_lines(finding, unit)),
        ]
    if not program.complete:
        lines.append("  and possibly more: the rest of the program was not read")
    return lines


def _place(placed: Placed) -> str:
    """The number of the line, and its text."""
    if placed.line is None:
        return "  the program"
    return f"  line {placed.line:<5} {shortened(placed.text.strip(), LONGEST)}".rstrip()


def _finding_lines(placed: Placed, unit: LengthUnit) -> list[str]:
    """The finding in words, wrapped; converted first, as a line may end before a unit."""
    finding = placed.finding
    said = f"{finding.rule}: {finding.what}"
    said += f", {finding.value}" if finding.value else ""
    said += f"; allowed: {finding.allowed}" if finding.allowed else ""
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
        help="value of the offset D, where the control compensates for the cutter: its radius, or"
        " its wear alone",
    ),
    Argument(
        "--scene",
        metavar="SCENE",
        help="scene that supplies tools, blank, holding and part",
    ),
    Argument(
        "--second-side",
        action="store_true",
        help="the programs mill the second side of the scene; those of camgeo state that"
        " themselves",
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the findings; exit code 0 without any, 1 with some, 2 if a file cannot be read."""
    clearance = arguments.clearance
    if clearance is not None and clearance < arguments.stock_top:
        raise CallError("argument --clearance: is below the top of the stock")
    bench = WorkData(arguments.stock_top, clearance, tuple(arguments.radius))
    paths = [Path(name) for name in arguments.files]
    design = opened(arguments) if arguments.scene is not None else None
    second = arguments.second_side
    if second and design is None:
        raise CallError("argument --second-side: needs --scene, which states the second side")
    return show(lint(paths, arguments.machine, bench, design, second_side=second), arguments)
