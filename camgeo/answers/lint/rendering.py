"""What `camgeo lint` finds, in words."""

from __future__ import annotations

import textwrap
from typing import Final

from camgeo.answers.lint import Lint, Placed, Program
from camgeo.units import LengthUnit, in_unit
from camgeo.wording import counted, shortened

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
    last = -1
    for each in found:
        place = each.line or 0
        if place != last:
            lines.append(_place(each))
        last = place
        lines += _said(each, unit)
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
