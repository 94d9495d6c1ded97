"""What `camgeo check` finds: a design compared with its limits, the real discs, cures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, ClassVar

from camgeo.answers.answer import Answer, exit_code
from camgeo.check.finding import forbidding
from camgeo.check.judge import RETURN
from camgeo.errors import GeometryError, ToleranceError
from camgeo.motion.joints import Joint, joints

if TYPE_CHECKING:
    from camgeo.cam.disc import Disc
    from camgeo.check.cures.cure import Cure
    from camgeo.check.finding import Finding
    from camgeo.design import Design
    from camgeo.outline.outline import Outline
    from camgeo.outline.path import Path, Pivot
    from camgeo.product.milled import MilledDisc
    from camgeo.scene.scene import Scene
    from camgeo.toolpath.machining_time import OperationTime


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
class Machining:
    """The program of the main disc, as its controller runs it.

    Attributes
    ----------
    machine : name of the controller.
    operations : the time of each.
    fault : why there is none; empty if there are.
    """

    machine: str
    operations: tuple[OperationTime, ...]
    fault: str = ""

    @property
    def seconds(self) -> float:
        """Of the whole program, tool changes and dwells left out."""
        return math.fsum(each.seconds for each in self.operations)


@dataclass(frozen=True, slots=True)
class Check(Answer):
    """The findings on a scene.

    Attributes
    ----------
    scene : that was checked.
    findings : all of them, good and bad, worst first.
    curves : the discs by their names, the main one first. None without a follower.
    cures : what would cure undercut, the cheapest first, then the changes that would not.
    effects : findings of each effect named by the scene; empty if there is no such mechanism.
    milled : the main disc as it is milled; None if the scene names no tool, or if there is no disc.
    """

    command: ClassVar[str] = "check"

    scene: Scene
    findings: tuple[Finding, ...]
    curves: Mapping[str, Disc]
    cures: tuple[Cure, ...]
    effects: Mapping[str, tuple[Finding, ...]]
    milled: MilledDisc | None = None

    @property
    def machining(self) -> Machining | None:
        """Machining time by operation; None if nothing is milled, or if the machine's dynamics are
        not known. Planned when asked for.
        """
        return None if self.milled is None else _machining(self.milled, self.scene)

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
        """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc."""
        return exit_code(chain(self.findings, *self.effects.values()))


def check(design: Design) -> Check:
    """Compare a design with its limits."""
    cams = zip((design.name, f"{design.name}-{RETURN}"), design.judgement.cams, strict=False)
    found = design.findings
    wrong = any(finding.severity == "invalid" for finding in found)
    named = () if wrong else design.scene.effects
    return Check(
        design.scene,
        found,
        {name: cam.disc for name, cam in cams},
        design.judgement.cures,
        {name: design.effects.findings(name) for name in named},
        None if design.scene.milling is None or forbidding(found) else design.disc.milled,
    )


def _machining(milled: MilledDisc, scene: Scene) -> Machining | None:
    # Few scenes are milled, and only their programs take a machine, a plan and fits.
    from camgeo.formats.gcode import FORMAT
    from camgeo.toolpath.machine import load
    from camgeo.toolpath.machining_time import times_on

    machine, tolerance = load(milled.options[FORMAT].machine), scene.output.tolerance
    if machine.dynamics is None:
        return None
    try:
        toolpath = milled.toolpath(tolerance)
    except (GeometryError, ToleranceError) as error:
        return Machining(machine.name, (), str(error))
    return Machining(machine.name, times_on(machine, toolpath, tolerance) or ())


def _remains(disc: Disc, flank: str) -> Remains | None:
    try:
        return Remains(disc.outline(flank))
    except GeometryError:
        return None


def _size(path: Path) -> float:
    from camgeo.outline.moments import area  # only JSON shows areas

    return abs(area(path))
