"""What `camgeo check` finds, in words."""

from __future__ import annotations

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
        lines += ["", *_machining(answer.machining)]
    return "\n".join(lines)


def _machining(found: Machining) -> list[str]:
    """The time of each operation, with what the controller loses."""
    if found.fault:
        return [f"machining: {found.fault}"]
    head = f"machining on {found.machine}: {clock(found.seconds)}, tool changes left out"
    width = max((len(each.name) for each in found.operations), default=0)
    return [head, *(f"  {each.name:{width}}  {_time(each)}" for each in found.operations)]


def _time(found: OperationTime) -> str:
    slowed = f", {100.0 * found.slowed:.0f} % lost below the feed" if found.slowed > LOST else ""
    rapid = f", of which traverses {clock(found.traverses)}" if found.traverses >= 0.5 else ""
    return f"{clock(found.seconds):>8}{rapid}{slowed}"
