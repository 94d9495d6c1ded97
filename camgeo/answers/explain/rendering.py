"""What `camgeo explain` finds, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final

from camgeo.answers.explain import Explanation
from camgeo.check.finding import Finding
from camgeo.lazy import Run
from camgeo.wording import counted

MILLI: Final = 1e3
INDENT: Final = "  "


def text(answer: Explanation) -> str:
    """The quantities as a tree, with their times, and what was not computed."""
    total = sum(each.own_seconds for each in answer.computed)
    number = counted(len(answer.computed), "quantity", "quantities")
    command = f"camgeo {answer.goal}"
    return "\n".join(
        (
            f"What `{command}` computes for {answer.scene.name}, each quantity below the one",
            "that first asked for it. Times in ms: with all that it asked for, and its own. Checks",
            "name their findings.",
            "",
            f"{'all':>10}{'own':>10}",
            *tree_lines(answer),
            "",
            f"{MILLI * total:10.3f}  in total, for {number}",
            "",
            f"Not computed: {', '.join(answer.left_alone) or 'nothing'}",
        )
    )


def tree_lines(answer: Explanation) -> list[str]:
    """One line per quantity, below the one that requested it first."""
    below: dict[str, list[Run]] = {}
    for each in answer.computed:
        below.setdefault(each.asked_by, []).append(each)
    shown: set[str] = set()

    def lines(asker: str, depth: int) -> list[str]:
        found = []
        for each in below.get(asker, []):
            notes = (answer.reasons.get(each.name, ""), "has no answer" if each.failed else "")
            note = "; ".join(filter(None, notes))
            told = each.name in answer.findings
            name = INDENT * depth + each.name
            found.append(
                f"{MILLI * each.seconds:10.3f}{MILLI * each.own_seconds:10.3f}  {name}"
                + (f"  ({note})" if note else "")
                + (f": {found_words(answer.findings[each.name])}" if told else "")
            )
            if each.name not in shown:
                shown.add(each.name)
                found += lines(each.name, depth + 1)
        return found

    return lines("", 0)


def found_words(findings: Iterable[Finding]) -> str:
    """The names of findings, with the severities of those that are not "ok"."""
    counts = Counter(
        each.name if each.severity == "ok" else f"{each.name} ({each.severity})"
        for each in findings
    )
    words = (name if count == 1 else f"{count} {name}" for name, count in counts.items())
    return ", ".join(words) or "none"
