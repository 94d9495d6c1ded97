"""The cuts of a part, planned or stated, with how it is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.part.part import Part
from camgeo.toolpath.bench import Bench
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.guard import guarded, require_room, told_of_holding
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import Heights
from camgeo.toolpath.planned import planned_steps, told
from camgeo.toolpath.stated import stated_cuts
from camgeo.toolpath.tool import COMPUTED

SEQUENCE: Final = "sequence"
"""Name of the finding that lists a planned sequence."""

MILLED: Final = ("outline", "rim", "inner flank", "outer flank", "bore")
"""Boundaries that programs make."""


@dataclass(frozen=True, slots=True)
class Sequence:
    """The cuts of a part.

    Attributes
    ----------
    cuts : in their order.
    findings : what is told of them, beside the notes that each has of its own.
    """

    cuts: tuple[Cut, ...]
    findings: tuple[Finding, ...]


def sequence_of(
    part: Part, milling: MillingSpec, heights: Heights, compensation: str = COMPUTED
) -> Sequence:
    """The cuts of a part from its blank, `compensation` that of finishes that do not state theirs.

    Raises
    ------
    GeometryError
        With the key of the scene, if a tool does not fit, something is missing, a clamp is in the
        way, or what is cut free is not held.
    """
    part.require_heights()
    for each in part.boundaries:
        if each.name not in MILLED:
            message = f"the {each.name} is not milled; leave gcode out of the formats"
            raise GeometryError(message, key="part")
    bench = Bench(part, milling, compensation)
    require_room(bench)
    findings: list[Finding] = []
    if milling.operations:
        cuts = stated_cuts(bench)
    else:
        steps = list(planned_steps(bench))
        cuts = [step for step in steps if isinstance(step, Cut)]
        findings = [step for step in steps if isinstance(step, Finding)]
        findings.insert(0, told(SEQUENCE, f"planned: {_listed(cuts)}"))
    cuts = guarded(bench, cuts, heights)
    findings += told_of_holding(bench, cuts)
    if milling.earlier:
        sentence = (
            "the tool is stated by earlier keys of [output.gcode], which are still read; [[tool]]"
            " states more"
        )
        findings.append(Finding("earlier-keys", "warning", sentence))
    return Sequence(tuple(cuts), tuple(findings))


def _listed(cuts: list[Cut]) -> str:
    return ", ".join(f"{cut.name} (tool {cut.tool.number})" for cut in cuts) or "nothing to mill"
