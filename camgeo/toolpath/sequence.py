"""The cuts of a part, planned or stated, with how it is held."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.part.engraving import text_of
from camgeo.part.part import Part
from camgeo.toolpath.bench import Bench
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.guard import guarded, require_room, require_size, told_of_holding
from camgeo.toolpath.judged import left_out
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import Heights
from camgeo.toolpath.planned import planned_steps, told
from camgeo.toolpath.stated import stated_cuts
from camgeo.toolpath.tool import COMPUTED

SEQUENCE: Final = "sequence"
"""Name of the finding that lists a planned sequence."""


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
    """The cuts of a part from its blank.

    Parameters
    ----------
    part : with its highest face at height 0.
    compensation : of finishes that do not state theirs.

    Raises
    ------
    GeometryError
        With the key of the scene, if a tool does not fit, something is missing or too large, a
        clamp is in the way, or what is cut free is not held.
    """
    part.require_heights()
    if part.layers[0] not in part.disc and milling.second is None and not milling.turned:
        message = "a hub on the lower face is milled from there: state [second_side]"
        raise GeometryError(message, key="part.hub.side", value=part.layers[0].name)
    bench = Bench(part, milling, compensation)
    require_size(bench)
    require_room(bench)
    findings: list[Finding] = []
    if milling.operations:
        cuts = stated_cuts(bench)
        # A second side may make what the first does not.
        left = [] if milling.second else [
            name for name in left_out(part, cuts) if name not in milling.done
        ]  # fmt: skip
        if left:
            named = dict.fromkeys(text_of(name) or name for name in left)
            sentence = f"no operation makes {', '.join(named)}"
            findings.append(Finding("left-out", "warning", sentence))
    else:
        steps = list(planned_steps(bench))
        cuts = [step for step in steps if isinstance(step, Cut)]
        findings = [step for step in steps if isinstance(step, Finding)]
        if milling.turned and not cuts:
            message = (
                "nothing is to be milled: the blank is not lower than the part, and the first side"
                " leaves no wall that is open on the lower face; state its operations"
            )
            raise GeometryError(message, "second_side")
        findings.insert(0, told(SEQUENCE, f"planned: {_listed(cuts)}"))
    if milling.turned:  # the machine runs the mirror image, see `camgeo.toolpath.turning`
        cuts = [replace(cut, climb=not cut.climb) for cut in cuts]
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
