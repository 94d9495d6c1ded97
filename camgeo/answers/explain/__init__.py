"""What `camgeo explain` finds: what a command computes for a scene, why, and how long it takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import ClassVar, Final

from camgeo.answers.answer import Answer
from camgeo.answers.check import OF_MILLING, OF_PART, Check, check
from camgeo.cam.disc import Disc
from camgeo.cam.drive import Drive
from camgeo.check.finding import Finding
from camgeo.check.judge import FINDINGS, Judgement
from camgeo.design import Design
from camgeo.lazy import Run, lazy_names
from camgeo.product.drawn import DrawnDisc
from camgeo.product.milled import MilledDisc
from camgeo.scene.scene import Scene

EFFECTS: Final = "effects."
"""Prefix of the names of quantities that are effects."""

BY_CHECK: Final = "by_check"
"""The quantity of `Judgement` that has the findings of its checks."""

OWNERS: Final = (Drive, Disc, Judgement, DrawnDisc, MilledDisc)
"""Classes with quantities that are computed on demand, in the order of the stages."""


@dataclass(frozen=True, slots=True)
class Explanation(Answer):
    """What a command computes.

    Attributes
    ----------
    scene : for which it does.
    goal : the command.
    computed : quantities, in the order in which they were finished.
    reasons : why effects among them were computed, by the names of the quantities.
    left_alone : quantities and effects that were not computed.
    findings : of the checks, effects and parts among them, by the names of the quantities.
    """

    command: ClassVar[str] = "explain"

    scene: Scene
    goal: str
    computed: tuple[Run, ...]
    reasons: Mapping[str, str]
    left_alone: tuple[str, ...]
    findings: Mapping[str, tuple[Finding, ...]]


def explain(design: Design, goal: str = "check") -> Explanation:
    """Do what a command of `GOALS` does with a new design, and report what that took."""
    made = GOALS[goal](design)
    runs = tuple(design.ledger.runs)
    ran = {_plain(each.name) for each in runs}
    effects = sorted({each.name for each in runs if each.name.startswith(EFFECTS)})
    reasons = {name: _reason(design, name) for name in effects}
    alone = tuple(name for name in quantities() if name not in ran)
    found = _found(design, made) if BY_CHECK in ran else {}
    return Explanation(design.scene, goal, runs, reasons, alone, found)


def _found(design: Design, made: object) -> dict[str, tuple[Finding, ...]]:
    """The findings of each check, effect and part, by the names of the quantities."""
    found = {f"{FINDINGS}{name}": own for name, own in design.judgement.by_check.items()}
    if isinstance(made, Check):
        found |= {f"{FINDINGS}{EFFECTS}{name}": own for name, own in made.effects.items()}
        if made.parts:
            own = (each.findings for each in made.parts.values())
            found[OF_PART] = tuple(chain.from_iterable(own))
        if made.machining is not None:
            found[OF_MILLING] = made.machining.findings
    return found


def _table(design: Design) -> None:
    """Compute what `camgeo table` needs."""
    design.tabulated.table()


def _build(design: Design) -> None:
    """Compute what `camgeo build` needs; nothing is written."""
    from camgeo.writing.write import make_files

    if design.judgement.has_outline:
        make_files(design.discs, design.scene.output.formats, design.scene.output.tolerance)


GOALS: Final[dict[str, Callable[[Design], object]]] = {
    "check": check,
    "table": _table,
    "build": _build,
}


def quantities() -> tuple[str, ...]:
    """Names of all quantities that a design computes on demand, including effects."""
    from camgeo.effects.nodes import node_name
    from camgeo.effects.registry import effect_names

    effects = (node_name(name) for name in effect_names())
    return (*(name for owner in OWNERS for name in lazy_names(owner)), *effects)


def _plain(quantity: str) -> str:
    """The name of a quantity without what the ledger adds for the state of an effect."""
    return quantity.partition(" ")[0] if quantity.startswith(EFFECTS) else quantity


def _reason(design: Design, quantity: str) -> str:
    """Why an effect was computed."""
    name = _plain(quantity).removeprefix(EFFECTS)
    inputs = design.effects.inputs(name)
    named = "named by the scene" if name in design.scene.effects else "needed"
    return named + (f"; from {', '.join(inputs)}" if inputs else "")
