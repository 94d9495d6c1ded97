"""What `camgeo check` finds: a design compared with its limits, the real discs, cures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, ClassVar, Final

from camgeo.app.answers.answer import Answer, exit_code, finding_lines
from camgeo.check.finding import RETURN, Finding, forbidding
from camgeo.check.judge import FINDINGS
from camgeo.design.judged_part import Body, PartFound
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import Joint, joints
from camgeo.scene.formats.format import find_format
from camgeo.units import clock

if TYPE_CHECKING:
    from camgeo.cam.cam import Disc
    from camgeo.check.cures.search import Cure
    from camgeo.design.design import Design
    from camgeo.design.machining import Machining
    from camgeo.geometry.outline.outline import Outline
    from camgeo.geometry.outline.path import Path, Pivot
    from camgeo.milling.machining_time import OperationTime
    from camgeo.scene.scene import Scene


FORMAT: Final = "format"
"""Name of findings on what a scene lacks for a format."""

PROGRAM: Final = "gcode"
"""The format of milling programs."""

OF_PART: Final = f"{FINDINGS}part"
OF_MILLING: Final = f"{FINDINGS}milling"
"""Names under which a ledger records them."""


@dataclass(frozen=True, slots=True)
class Remains:
    """What is left of a flank on the real disc; areas are computed when they are asked for.

    Attributes
    ----------
    outline : of the real disc.
    """

    outline: Outline

    @property
    def area(self) -> float:
        """Inside of the outline [mm^2]."""
        return _size(self.outline.path)

    @property
    def corners(self) -> tuple[Pivot, ...]:
        """Of the outline."""
        return tuple(pivot for pivot in self.outline.path.pivots if pivot.distance == 0.0)

    @property
    def lobes(self) -> tuple[float, ...]:
        """Areas of what is cut off and falls away [mm^2]."""
        return tuple(_size(lobe) for lobe in self.outline.lobes)


@dataclass(frozen=True, slots=True)
class Check(Answer):
    """The findings on a scene.

    Attributes
    ----------
    scene : that was checked.
    findings : all of them, good and bad, worst first.
    curves : the discs by their names, the main one first. None without a follower.
    cures : what would cure undercut, transmission angle and radius ratio, fault by fault, the
        cheapest first, then the changes that would not.
    effects : findings of each effect named by the scene; empty if there is no such mechanism.
    parts : the part of each disc by names, the main one first, and of a pair in one piece; empty
        if there is no disc.
    machining : the milling programs; None if the scene states no milling, or lacks what that
        needs, or if there is no disc.
    formats : what the scene lacks for the formats that it names, "broken", and for a program if it
        states how to mill, "ok" if it does not name that format.
    """

    command: ClassVar[str] = "check"

    scene: Scene
    findings: tuple[Finding, ...]
    curves: Mapping[str, Disc]
    cures: tuple[Cure, ...]
    effects: Mapping[str, tuple[Finding, ...]]
    parts: Mapping[str, PartFound]
    machining: Machining | None = None
    formats: tuple[Finding, ...] = ()

    @property
    def discs(self) -> dict[str, dict[str, Remains | None]]:
        """What is left of the flanks in use of each disc, by names; None if nothing is, or if that
        is not known. Computed when asked for: near a dead centre outlines take long.
        """
        return {
            name: {flank: _remains(disc, flank) for flank, _ in disc.flanks}
            for name, disc in self.curves.items()
        }

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Where the segments of the motion meet, by ascending cam angle."""
        return joints(self.scene.plan)

    @property
    def exit_code(self) -> int:
        """2 if there is no such mechanism or part or no program of it can be planned, 1 if a limit
        is broken, there is no such disc, a program must not be run, or a format lacks what it
        needs.
        """
        return exit_code(self.everything)

    @property
    def everything(self) -> tuple[Finding, ...]:
        """All findings: on the cam, on effects, parts, programs and formats."""
        milling = () if self.machining is None else self.machining.findings
        parts = (each.findings for each in self.parts.values())
        own = (*self.effects.values(), *parts, milling, self.formats)
        return tuple(chain(self.findings, *own))


def check(design: Design, *, machining: bool = True) -> Check:
    """Compare a design with its limits; without its milling programs if not `machining`."""
    cams = zip((design.name, f"{design.name}-{RETURN}"), design.judgement.cams, strict=False)
    found = design.findings
    wrong = any(finding.severity == "invalid" for finding in found)
    named = () if wrong else design.scene.effects
    parts = _parts(design) if design.judgement.cams and not forbidding(found) else {}
    milled = machining and design.scene.milling is not None and not forbidding(found)
    milled = milled and not design.scene.lacking([find_format(PROGRAM)])
    return Check(
        design.scene,
        found,
        {name: cam.disc for name, cam in cams},
        design.judgement.cures,
        {name: design.effects.findings(name) for name in named},
        parts,
        _machining(design) if milled else None,
        tuple(_lacking(design.scene)),
    )


def _lacking(scene: Scene) -> Iterator[Finding]:
    """What the scene lacks for the formats that it names, and for a program if it states any of
    what that needs.
    """
    named: list[str] = scene.stated.get("output", "formats") or []
    names = dict.fromkeys((*named, PROGRAM) if scene.states_milling else named)
    for name in names:
        for fault in scene.lacking([find_format(name)]):
            yield Finding(FORMAT, "broken" if name in named else "ok", str(fault))


def _parts(design: Design) -> dict[str, PartFound]:
    from camgeo.design.judged_part import part_of  # a motion alone has none
    from camgeo.design.product import with_pair

    with design.ledger.entry(OF_PART):
        return {disc.name: part_of(disc) for disc in with_pair(design.discs)}


def _machining(design: Design) -> Machining:
    from camgeo.design.machining import machining_of  # few scenes are milled

    with design.ledger.entry(OF_MILLING):
        return machining_of(design.discs)


def _remains(disc: Disc, flank: str) -> Remains | None:
    try:
        return Remains(disc.outline(flank))
    except GeometryError:
        return None


def _size(path: Path) -> float:
    from camgeo.geometry.outline.path import area  # only JSON shows areas

    return abs(area(path))


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo check` finds, in words.


LOST: Final = 0.01
"""Share of the cutting time by which an operation may miss its feeds without a word."""

CURES: Final = "Each of these cures the fault that it names; check again, for the effects as well:"


def text(answer: Check) -> str:
    """The findings, what would cure them, and the findings of the effects."""
    lines = finding_lines(answer.findings)
    if answer.cures:
        lines += ["", CURES]
        lines += [f"  {cure.statement}" for cure in answer.cures]
    for name, found in answer.effects.items():
        lines += ["", f"{name}:", *finding_lines(found)]
    several = len(answer.parts) > 1
    for name, part in answer.parts.items():
        lines += ["", f"part of {name}:" if several else "part:", *_part(part)]
    if answer.machining is not None:
        lines += _machining_text(answer.machining)
    if answer.formats:
        lines += ["", "formats:", *finding_lines(answer.formats)]
    return "\n".join(lines)


def _part(found: PartFound) -> list[str]:
    """Size, mass and moments of inertia of a part."""
    told = [f"section through the {each.name} {each.area:.6g} mm^2" for each in found.layers]
    if found.body is not None:
        told += _body(found.body)
    return [*finding_lines(found.findings), *(f"{'':8}{line}" for line in told)]


def _body(body: Body) -> list[str]:
    centre = ", ".join(_shown(each, body.solid.centre_error) for each in body.solid.centre)
    lines = [f"volume {body.solid.volume:.6g} mm^3, centre of mass ({centre}) mm"]
    if body.axial_inertia is None or body.inertia is None:
        return [*lines, "no mass: the scene states no density"]
    about = ", ".join(f"{each:.6g}" for each in body.inertia.diagonal())
    axial = f"moment of inertia about the cam axis {body.axial_inertia:.6g} kg mm^2"
    return [*lines, f"{axial}; about x, y, z through the centre of mass {about} kg mm^2"]


def _shown(value: float, error: float) -> str:
    """A coordinate that its error may be all of is 0."""
    return "0" if abs(value) <= error else f"{value:.6g}"


def _machining_text(found: Machining) -> list[str]:
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
