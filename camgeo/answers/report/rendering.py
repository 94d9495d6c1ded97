"""What `camgeo report` gathers, in words."""

from __future__ import annotations

from collections import Counter

from camgeo.answers.answer import MANY, MARKS
from camgeo.answers.report import Report
from camgeo.wording import counted


def text(answer: Report) -> str:
    """The verdict, what the page has, what it lacks, and the next steps."""
    verdicts = Counter[str](each.finding.verdict for each in answer.advised)
    several = (each for each in MARKS if verdicts[each])
    found = ", ".join(counted(verdicts[each], MARKS[each], MANY[each]) for each in several)
    lines = [f"{answer.scene.name}: {counted(len(answer.advised), 'finding')}: {found}"]
    lines += [f"  {chart.title}: {chart.sentence}" for chart in answer.charts]
    lines += [f"  left out: {each}" for each in answer.left_out]
    lines += [
        f"{MARKS[each.finding.severity]:8}{each.finding.name}: {each.step}"
        for each in answer.advised
        if each.step
    ]
    return "\n".join(lines)
