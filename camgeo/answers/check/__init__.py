"""What `camgeo check` finds: a design compared with its limits, the real discs, cures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, ClassVar, Final

from camgeo.answers.answer import Answer, exit_code
from camgeo.check.finding import RETURN, Finding, forbidding
from camgeo.check.judge import FINDINGS
from camgeo.errors import GeometryError
from camgeo.formats.registry import find_format
from camgeo.motion.joints import Joint, joints

if TYPE_CHECKING:
    from camgeo.cam.disc import Disc
    from camgeo.check.cures.cure import Cure
    from camgeo.design import Design
    from camgeo.outline.outline import Outline
    from camgeo.outline.path import Path, Pivot
    from camgeo.product.judged_part import PartFound
    from camgeo.product.machining import Machining
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
    from camgeo.product.judged_part import part_of  # a motion alone has none
    from camgeo.product.product import with_pair

    def found() -> dict[str, PartFound]:
        return {disc.name: part_of(disc) for disc in with_pair(design.discs)}

    return design.ledger.run(OF_PART, found)


def _machining(design: Design) -> Machining:
    from camgeo.product.machining import machining_of  # few scenes are milled

    return design.ledger.run(OF_MILLING, lambda: machining_of(design.discs))


def _remains(disc: Disc, flank: str) -> Remains | None:
    try:
        return Remains(disc.outline(flank))
    except GeometryError:
        return None


def _size(path: Path) -> float:
    from camgeo.outline.moments import area  # only JSON shows areas

    return abs(area(path))
