"""What `camgeo check` finds, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from camgeo.answers.answer import finding_lines
from camgeo.answers.check import Check, Machining
from camgeo.wording import clock

if TYPE_CHECKING:
    from camgeo.toolpath.machining_time import OperationTime

LOST: Final = 0.01
"""Share of the cutting time by which an operation may miss its feeds without a word."""

CURES: Final = "Any one of these cures the undercut; it may break another limit, so check again:"


def text(answer: Check) -> str:
    """The findings, what would cure undercut, and the findings of the effects."""
    lines = finding_lines(answer.findings)
    if answer.cures:
        lines += ["", CURES]
        lines += [f"  {'' if cure.works else 'no cure: '}{cure.sentence}" for cure in answer.cures]
    for name, found in answer.effects.items():
        lines += ["", f"{name}:", *finding_lines(found)]
    if answer.machining is not None:
        lines += _machining(answer.machining)
    return "\n".join(lines)


def _machining(found: Machining) -> list[str]:
    """What is found on each program; the time of each operation, with what the controller loses."""
    lines: list[str] = []
    several = len(found.programs) > 1
    for name, program in found.programs.items():
        head = f"milling of {name}:" if several else "milling:"
        told = finding_lines(program.findings)
        lines += ["", head, *told] if told else ["", f"{head} simulated, nothing found"]
        lines += [f"{'':8}{each.operation}: {each.sentence}" for each in program.roughing]
    timed = {name: each for name, each in found.programs.items() if each.operations is not None}
    if not timed:
        return lines
    total = clock(math.fsum(each.seconds or 0.0 for each in timed.values()))
    lines += ["", f"machining on {found.machine}: {total}, tool changes left out"]
    for name, program in timed.items():
        times = program.operations or ()
        lines += [f"  {name}: {clock(program.seconds or 0.0)}"] if several else []
        width = max((len(each.name) for each in times), default=0)
        lead = "    " if several else "  "
        lines += [f"{lead}{each.name:{width}}  {_time(each)}" for each in times]
    return lines


def _time(found: OperationTime) -> str:
    slowed = f", {100.0 * found.slowed:.0f} % lost below the feed" if found.slowed > LOST else ""
    rapid = f", of which traverses {clock(found.traverses)}" if found.traverses >= 0.5 else ""
    return f"{clock(found.seconds):>8}{rapid}{slowed}"
