"""What `camgeo check` finds, in words."""

from __future__ import annotations

from typing import Final

from camgeo.answers.answer import finding_lines
from camgeo.answers.check import Check

CURES: Final = "Any one of these cures the undercut; it may break another limit, so check again:"


def text(answer: Check) -> str:
    """The findings, what would cure undercut, and the findings of the effects."""
    lines = finding_lines(answer.findings)
    if answer.cures:
        lines += ["", CURES]
        lines += [f"  {'' if cure.works else 'no cure: '}{cure.sentence}" for cure in answer.cures]
    for name, found in answer.effects.items():
        lines += ["", f"{name}:", *finding_lines(found)]
    return "\n".join(lines)
