"""A disc as milling programs cut it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import TYPE_CHECKING, TypeVar

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError, UndercutError, UnsafeError
from camgeo.formats.gcode import FORMAT
from camgeo.lazy import Ledger, built, lazy
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.formats.format import Options
    from camgeo.part.part import Part
    from camgeo.product.drawn import DrawnDisc
    from camgeo.scene.scene import Scene
    from camgeo.toolpath.cut import ContourCut, Cut
    from camgeo.toolpath.engaged import Engaged
    from camgeo.toolpath.milling import MillingSpec
    from camgeo.toolpath.moves import Toolpath
    from camgeo.toolpath.sequence import Sequence
    from camgeo.toolpath.stages import Flaw
    from camgeo.toolpath.zero import Zero

Planned = TypeVar("Planned")


@dataclass(frozen=True)
class MilledDisc(Pickled):
    """A disc as seen by milling programs.

    What cannot be planned raises `SceneError` with the key that is at fault.

    Attributes
    ----------
    drawn : the disc to be milled.
    scene : with tools, blank, holding and operations; what milling needs may be missing.
    ledger : records what was computed.
    whole : of which this is one program, if the machine cannot change the tools that the disc
        needs; None if it is all.
    program : number of this one from 0.
    """

    drawn: DrawnDisc
    scene: Scene
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    whole: MilledDisc | None = None
    program: int = 0

    @property
    def options(self) -> Options:
        """Include the machine and the heights of traverses."""
        return self.scene.output.options

    @property
    def spec(self) -> MillingSpec | None:
        """Tools, blank, holding and operations; None if the scene says nothing on milling."""
        return self.scene.milling

    @built
    def part(self) -> Part:
        """The part as programs see it: its highest face is at height 0."""
        return self.drawn.part.lowered()

    @lazy
    def sequence(self) -> Sequence:
        """The exact cuts of all programs, and what is told of them; raises SceneError if the scene
        lacks what milling needs, or its tools cannot do it.
        """
        return self._planned(self._sequence) if self.whole is None else self.whole.sequence

    def _sequence(self) -> Sequence:
        from camgeo.toolpath.sequence import sequence_of

        if lacking := FORMAT.lacking(self.scene.stated):
            raise GeometryError(f"milling {'; '.join(lacking)}", key="output.gcode")
        assert self.spec is not None  # for the scene has a tool
        options = self.options[FORMAT]
        return sequence_of(self.part, self.spec, options.heights, options.compensation)

    def _planned(self, plan: Callable[[], Planned]) -> Planned:
        """What `plan` makes; what it finds wrong is the scene's fault."""
        try:
            return plan()
        except UndercutError:  # of the disc, not of how it is milled
            raise
        except GeometryError as error:
            from camgeo.scene.milling import refused  # few scenes mill

            scene = self.scene
            raise refused(scene.stated, error, scene.source.file) from error

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """The exact cuts, in their order."""
        cuts = self.sequence.cuts
        return cuts if self.whole is None else self.groups[self.program]

    @property
    def groups(self) -> tuple[tuple[Cut, ...], ...]:
        """The cuts of each program: all in one, unless the machine cannot change tools."""
        from camgeo.toolpath.machine import load

        cuts = self.sequence.cuts
        if load(self.options[FORMAT].machine).tool_change.change or not cuts:
            return (cuts,)
        return tuple(tuple(own) for _, own in groupby(cuts, key=lambda cut: cut.tool.number))

    @property
    def programs(self) -> tuple[MilledDisc, ...]:
        """One for each program, in the order in which they are run."""
        count = len(self.groups)
        if count == 1 or self.whole is not None:
            return (self,)
        return tuple(replace(self, whole=self, program=number) for number in range(count))

    @property
    def contour_cuts(self) -> tuple[ContourCut, ...]:
        """Those along a closed path, by which programs are measured."""
        from camgeo.toolpath.cut import ContourCut

        return tuple(cut for cut in self.cuts if isinstance(cut, ContourCut))

    @property
    def told(self) -> tuple[str, ...]:
        """What is told of the sequence and of this program, a sentence each; raises like
        `sequence`.
        """
        told = tuple(finding.sentence for finding in self.sequence.findings)
        if self.whole is None:
            return told
        tool, count = self.cuts[0].tool.number, len(self.groups)
        own = (
            f"program {self.program + 1} of {count}, run in this order: tool {tool} is in the"
            " spindle, and Z 0 set with it, at the start"
        )
        return (own, *told)

    @property
    def zero(self) -> Zero:
        """Of the program; raises SceneError if the blank has no such corner."""
        from camgeo.toolpath.stock import Stock
        from camgeo.toolpath.zero import zero_of

        stock = Stock() if self.spec is None else self.spec.stock
        return self._planned(lambda: zero_of(self.options[FORMAT], stock, self.part))

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.toolpath.machine import load
        from camgeo.toolpath.plan import plan_toolpath

        cuts, spec, effort = self.cuts, self.options[FORMAT], self.drawn.effort
        limits, heights = load(spec.machine).arcs, spec.heights
        return self._planned(
            lambda: self.ledger.run(
                "toolpath", lambda: plan_toolpath(cuts, heights, limits, tolerance, effort)
            )
        )

    def flaws(self, toolpath: Toolpath, tolerance: float) -> tuple[Flaw, ...]:
        """What the simulation of a program finds that lies within `tolerance` [mm]."""
        from camgeo.toolpath.verdict import flaws_of

        part, spec = self.part, self.spec
        assert spec is not None  # for there is a program
        return self.ledger.run("simulation", lambda: flaws_of(toolpath, part, spec, tolerance))

    def engaged(self, toolpath: Toolpath) -> tuple[Engaged, ...]:
        """How the cutter is engaged in each roughing operation of a program."""
        from camgeo.toolpath.engaged import engaged_of

        part, spec = self.part, self.spec
        assert spec is not None  # for there is a program
        return self.ledger.run("engagement", lambda: engaged_of(toolpath, part, spec))

    def findings(self, toolpath: Toolpath, tolerance: float) -> tuple[Finding, ...]:
        """What is told of the sequence and its programs, and what their simulation finds: "broken"
        if they must not be run.
        """
        from camgeo.toolpath.verdict import verdict

        found = verdict(self.flaws(toolpath, tolerance))
        names = {each.name for each in found}
        told = [each for each in self.sequence.findings if each.name not in names]
        if low := self._low_change():
            told.append(Finding("tool-change-height", "warning", low))
        if len(self.groups) > 1:
            tools = ", ".join(str(own[0].tool.number) for own in self.groups)
            sentence = (
                f"the machine cannot change tools: {len(self.groups)} programs, tools {tools}"
            )
            told.append(Finding("programs", "warning", sentence))
        return (*told, *found)

    def _low_change(self) -> str:
        """That tools are changed close above the part, by nobody's wish; empty if not."""
        from camgeo.toolpath.machine import load

        spec = self.options[FORMAT]
        machine = load(spec.machine)
        several = any(len({cut.tool.number for cut in own}) > 1 for own in self.groups)
        if not (several and machine.retract.is_a_height and spec.tool_change_height is None):
            return ""
        return (
            f"tools are changed at the clearance height, Z {spec.clearance_height:g} mm, unless the"
            " machine moves away by itself; output.gcode.tool_change_height states another"
        )

    def safe(self, toolpath: Toolpath, tolerance: float) -> tuple[Finding, ...]:
        """What is to be watched in a program; raises UnsafeError if it must not be run."""
        found = self.findings(toolpath, tolerance)
        if wrong := "; ".join(each.sentence for each in found if each.severity == "broken"):
            raise UnsafeError(f"the milling program must not be run: {wrong}", key="output.gcode")
        return tuple(each for each in found if each.severity != "ok")
