"""Answer of `camgeo explain`: what a command computes for a scene, why, and how long it takes."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Final, Literal

from camgeo.app.answers.answer import SCENE, Answer, Key
from camgeo.app.answers.check import OF_MILLING, OF_PART, Check, check
from camgeo.app.cli.command import SCENE_FILE, Argument, opened, show
from camgeo.cam.cam import Disc, Drive
from camgeo.check.finding import FINDINGS, Finding
from camgeo.check.judge import Judgement
from camgeo.design.design import Design
from camgeo.design.drawn import DrawnDisc
from camgeo.design.milled import MilledDisc
from camgeo.lazy import Computation, built, lazy
from camgeo.scene.scene import Scene
from camgeo.units import counted

EFFECTS: Final = "effects."
"""Prefix of the names of quantities that are effects."""

BY_CHECK: Final = "by_check"
"""The quantity of `Judgement` that has the findings of its checks."""

OWNERS: Final = (Drive, Disc, Judgement, DrawnDisc, MilledDisc)
"""Classes with quantities that are computed on demand, in the order of the stages."""


@dataclass(frozen=True, slots=True)
class Explanation(Answer):
    """The quantities that a command computes.

    Attributes
    ----------
    scene : for which the command runs.
    goal : name of the command.
    computed : quantities, in the order in which they were finished.
    reasons : why effects among them were computed, by the names of the quantities.
    left_alone : quantities and effects that were not computed.
    findings : of the checks, effects and parts among them, by the names of the quantities.
    """

    scene: Scene
    goal: str
    computed: tuple[Computation, ...]
    reasons: Mapping[str, str]
    left_alone: tuple[str, ...]
    findings: Mapping[str, tuple[Finding, ...]]


def explain(design: Design, goal: str = "check") -> Explanation:
    """Run a command of `GOALS` on a new design; report what it computed, and the times."""
    answer = GOALS[goal](design)
    runs = tuple(design.ledger.runs)
    ran = {_plain(computed.name) for computed in runs}
    effects = sorted({computed.name for computed in runs if computed.name.startswith(EFFECTS)})
    reasons = {name: _reason(design, name) for name in effects}
    alone = tuple(name for name in quantities() if name not in ran)
    findings = _findings_by_quantity(design, answer) if BY_CHECK in ran else {}
    return Explanation(design.scene, goal, runs, reasons, alone, findings)


def _findings_by_quantity(design: Design, answer: object) -> dict[str, tuple[Finding, ...]]:
    """The findings of each check, effect and part, by the names of the quantities."""
    findings = {f"{FINDINGS}{name}": group for name, group in design.judgement.by_check.items()}
    if isinstance(answer, Check):
        findings |= {f"{FINDINGS}{EFFECTS}{name}": group for name, group in answer.effects.items()}
        if answer.parts:
            part_findings = (part.findings for part in answer.parts.values())
            findings[OF_PART] = tuple(chain.from_iterable(part_findings))
        if answer.machining is not None:
            findings[OF_MILLING] = answer.machining.findings
    return findings


def _table(design: Design) -> None:
    """Compute what `camgeo table` needs."""
    design.tabulated.table()


def _build(design: Design) -> None:
    """Compute what `camgeo build` needs; nothing is written."""
    from camgeo.design.writing import make_files

    if design.judgement.has_outline:
        make_files(design.discs, design.scene.output.formats, design.scene.output.tolerance)


GOALS: Final[dict[str, Callable[[Design], object]]] = {
    "check": check,
    "table": _table,
    "build": _build,
}


def quantities() -> tuple[str, ...]:
    """Names of all quantities that a design computes on demand, including effects."""
    from camgeo.dynamics.effects.graph import node_name
    from camgeo.dynamics.effects.registry import effect_names

    effects = (node_name(name) for name in effect_names())
    return (*(name for owner in OWNERS for name in lazy_names(owner)), *effects)


def lazy_names(owner: type) -> tuple[str, ...]:
    """Names of the lazy quantities of a class, in the order of their definition."""
    names = [
        name for base in reversed(owner.__mro__) for name, value in vars(base).items()
        if isinstance(value, lazy) and not isinstance(value, built)
    ]  # fmt: skip
    return tuple(dict.fromkeys(names))


def _plain(quantity: str) -> str:
    """The name of a quantity without the operating condition that the ledger adds for effects."""
    return quantity.partition(" ")[0] if quantity.startswith(EFFECTS) else quantity


def _reason(design: Design, quantity: str) -> str:
    """Why an effect was computed, and from which other effects."""
    name = _plain(quantity).removeprefix(EFFECTS)
    inputs = design.effects.inputs(name)
    named = "named by the scene" if name in design.scene.effects else "needed"
    return named + (f"; from {', '.join(inputs)}" if inputs else "")


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "What a command computes for a scene, for which other quantity, and how long it takes.",
    {
        "scene": SCENE,
        "command": Key(
            "The command that is explained.", of="goal", type=Literal["check", "table", "build"]
        ),
        "computed": Key(
            "The quantities that were computed, in order of completion.",
            {
                "name": "Name of the quantity.",
                "asked_by": Key(
                    "The quantity for which it was computed; empty if the command itself needed"
                    " it.",
                    of="requester",
                ),
                "seconds": "Time taken, including everything that it needed.",
                "own_seconds": Key("Time taken, without what it needed.", of="net_seconds"),
                "failed": "Whether it has no result.",
            },
        ),
        "reasons": "Why effects among them were computed, by the names of the quantities.",
        "left_alone": "Quantities and effects that were not computed.",
        "findings": Key(
            "The findings of each check, effect and part among them, by the names of the"
            " quantities;"
            ' "findings.effects.NAME" are those of an effect.',
            {
                "name": "Name of the finding.",
                "severity": "Severity of the finding.",
                "verdict": (
                    "What is said of it: its severity, or, of a finding that nothing limits,"
                    ' "figure" if it has a value and "note" if not.'
                ),
            },
        ),
    },
    type=Explanation,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo explain` in words.


MILLI: Final = 1e3
INDENT: Final = "  "


def text(answer: Explanation) -> str:
    """The quantities as a tree, with their times, and what was not computed."""
    total = sum(quantity.net_seconds for quantity in answer.computed)
    number = counted(len(answer.computed), "quantity", "quantities")
    command = f"camgeo {answer.goal}"
    return "\n".join(
        (
            f"What `{command}` computes for {answer.scene.name}, each quantity below the one",
            "that first needed it. Times in ms: with everything that it needed, and its own.",
            "Checks name their findings.",
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
    below: dict[str, list[Computation]] = {}
    for quantity in answer.computed:
        below.setdefault(quantity.requester, []).append(quantity)
    expanded: set[str] = set()

    def lines(asker: str, depth: int) -> list[str]:
        rows = []
        for quantity in below.get(asker, []):
            notes = (
                answer.reasons.get(quantity.name, ""),
                "has no result" if quantity.failed else "",
            )
            note = "; ".join(filter(None, notes))
            has_findings = quantity.name in answer.findings
            name = INDENT * depth + quantity.name
            rows.append(
                f"{MILLI * quantity.seconds:10.3f}{MILLI * quantity.net_seconds:10.3f}  {name}"
                + (f"  ({note})" if note else "")
                + (f": {findings_text(answer.findings[quantity.name])}" if has_findings else "")
            )
            # What a quantity needed is listed below its first line only.
            if quantity.name not in expanded:
                expanded.add(quantity.name)
                rows += lines(quantity.name, depth + 1)
        return rows

    return lines("", 0)


def findings_text(findings: Iterable[Finding]) -> str:
    """The names of findings, with the severities of those that are not "ok"."""
    counts = Counter(
        finding.name if finding.severity == "ok" else f"{finding.name} ({finding.severity})"
        for finding in findings
    )
    words = (name if count == 1 else f"{count} {name}" for name, count in counts.items())
    return ", ".join(words) or "none"


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo explain fixtures/scenes/setzhub.toml build"


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "command",
        metavar="COMMAND",
        nargs="?",
        default="check",
        choices=tuple(GOALS),
        help=f"one of {', '.join(GOALS)}; default check. nothing is written",
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Compute what the command computes, and print how long each quantity took."""
    design = opened(arguments)
    answer = explain(design, arguments.command)
    return show(answer, arguments)
