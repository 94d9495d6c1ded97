"""A disc as milling programs cut it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import TYPE_CHECKING

from camgeo.check.finding import Finding, findings_in_unit
from camgeo.errors import GeometryError, SceneError, UndercutError, UnsafeError
from camgeo.lazy import Ledger, built, lazy
from camgeo.numeric.kept import Kept, kept_with_owner
from camgeo.record import Pickled
from camgeo.scene.formats.gcode import FORMAT

if TYPE_CHECKING:
    from camgeo.design.drawn import DrawnDisc
    from camgeo.milling.cut import ContourCut, Cut
    from camgeo.milling.judged import Feature, SimulatedSide
    from camgeo.milling.milling import GcodeSpec, MillingSpec
    from camgeo.milling.moves import Toolpath, Zero
    from camgeo.milling.plan import OperationEngagement
    from camgeo.milling.planned import CutSequence
    from camgeo.milling.simulation import Flaw, ToolRun
    from camgeo.part.part import Part
    from camgeo.scene.scene import Scene


@dataclass(frozen=True)
class MilledDisc(Pickled):
    """One side of a disc as seen by its milling programs, in coordinates in which tools come from
    above (`camgeo.milling.milling`).

    What cannot be planned raises `SceneError` with the key that is at fault.

    Attributes
    ----------
    disc : the disc to be milled.
    scene : the scene with tools, blank, holding and operations; what milling needs may be missing.
    ledger : records what was computed.
    whole : the side of which this is one program, if the machine cannot change the tools that the
        disc needs; None if this is the whole side.
    program : number of this program from 0.
    first : the first side of the disc, if this is the second.
    kept : the latest program, see `kept_with_owner`: times, findings and files come from one plan.
    """

    disc: DrawnDisc
    scene: Scene
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    whole: MilledDisc | None = None
    program: int = 0
    first: MilledDisc | None = None
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    @built
    def second(self) -> MilledDisc | None:
        """The second side; None if there is none, or if this is it."""
        spec = self.scene.milling
        if self.first is not None or spec is None or spec.second is None:
            return None
        ledger = self.ledger.named(" of the second side")
        return replace(self, whole=None, program=0, first=self, ledger=ledger)

    @built
    def part(self) -> Part:
        """The part as programs see it: its highest face is at height 0."""
        part = self.disc.part
        return part.lowered() if self.first is None else part.turned_over()

    @property
    def gcode(self) -> GcodeSpec:
        """The options of its programs: the machine, zero, work offset, the heights of traverses."""
        options, spec = self.scene.output.options[FORMAT], self.scene.milling
        if self.first is None or spec is None or spec.second is None:
            return options
        second = spec.second
        with self._faults_of_scene():
            return second.program(options)

    @built
    def spec(self) -> MillingSpec | None:
        """Tools, blank, holding and operations; None if the scene states nothing about milling.

        Those of the second side follow from the sequence of the first, and raise as that does.
        """
        spec, first = self.scene.milling, self.first
        if first is None or spec is None:
            return spec
        from camgeo.milling.judged import Side

        return Side(first.part, spec, first.sequence.cuts, ()).left_to_do

    @lazy
    def sequence(self) -> CutSequence:
        """The exact cuts of all programs, with the findings of planning; raises SceneError if the
        scene lacks what milling needs, or its tools cannot do it.
        """
        if self.whole is not None:
            return self.whole.sequence
        from camgeo.milling.planned import plan_sequence

        with self._faults_of_scene():
            if lacking := self.scene.lacking([FORMAT]):
                raise SceneError(lacking, self.scene.source.file)
            assert self.spec is not None  # for the scene has a tool
            options = self.gcode
            planned = plan_sequence(self.part, self.spec, options.heights, options.compensation)
            return replace(planned, findings=findings_in_unit(self.scene.unit, planned.findings))

    @contextmanager
    def _faults_of_scene(self) -> Iterator[None]:
        """Raise errors of planning as faults of the scene."""
        try:
            yield
        except UndercutError:  # a fault of the disc, not of how it is milled
            raise
        except GeometryError as error:
            from camgeo.milling.milling import of_second_side
            from camgeo.scene.milling import planning_error  # few scenes mill

            scene = self.scene
            error = error if self.first is None else of_second_side(error)
            raise planning_error(scene.stated, error, scene.source.file) from error

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """The exact cuts, in their order."""
        cuts = self.sequence.cuts
        return cuts if self.whole is None else self._groups[self.program]

    @property
    def _groups(self) -> tuple[tuple[Cut, ...], ...]:
        """The cuts of each program: all in one, unless the machine cannot change tools."""
        from camgeo.milling.machine import load

        cuts = self.sequence.cuts
        if load(self.gcode.machine).tool_change.change or not cuts:
            return (cuts,)
        return tuple(tuple(group) for _, group in groupby(cuts, key=lambda cut: cut.tool.number))

    @property
    def programs(self) -> tuple[MilledDisc, ...]:
        """The side once for each of its programs, in the order in which they are run."""
        count = len(self._groups)
        if count == 1 or self.whole is not None:
            return (self,)
        return tuple(replace(self, whole=self, program=number) for number in range(count))

    @property
    def contour_cuts(self) -> tuple[ContourCut, ...]:
        """The cuts along a closed path, by which programs are measured."""
        from camgeo.milling.cut import ContourCut

        return tuple(cut for cut in self.cuts if isinstance(cut, ContourCut))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the sequence and on this program, a sentence each; raises like `sequence`."""
        sentences = tuple(finding.sentence for finding in self.sequence.findings)
        if self.whole is None:
            return sentences
        tool, count = self.cuts[0].tool.number, len(self._groups)
        order = (
            f"program {self.program + 1} of {count}, run in this order: tool {tool} is in the"
            " spindle, and Z 0 set with it, at the start"
        )
        return (order, *sentences)

    @property
    def zero(self) -> Zero:
        """The zero point of the program; raises SceneError if the blank has no such corner."""
        from camgeo.milling.milling import AXIS, FIRST_SIDE, Stock
        from camgeo.milling.moves import Zero

        stock = Stock() if self.spec is None else self.spec.stock
        turned = FIRST_SIDE if self.spec is None else self.spec.turned
        with self._faults_of_scene():
            stated_zero, first = Zero.stated(self.gcode, stock, self.part, turned), self.first
            if (
                first is not None
                and first.spec is not None
                and stated_zero.name != AXIS
                and first.sequence.is_cut_free
            ):
                message = "there is no corner: the first side cuts the part out of the blank"
                raise GeometryError(message, "output.gcode.zero", f'"{stated_zero.name}"')
        return stated_zero

    @kept_with_owner
    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.milling.machine import load
        from camgeo.milling.plan import plan_toolpath

        cuts, spec, effort = self.cuts, self.gcode, self.disc.effort
        limits, heights = load(spec.machine).arcs, spec.heights
        with self._faults_of_scene(), self.ledger.entry("toolpath"):
            return plan_toolpath(cuts, heights, limits, tolerance, effort)

    def flaws(self, toolpath: Toolpath, tolerance: float) -> tuple[Flaw, ...]:
        """The flaws that the simulation of a program finds, which lies within `tolerance` [mm]; the
        second side begins with what the first one leaves.
        """
        from camgeo.milling.judged import side_flaws, toolpath_runs

        cuts = tuple(operation.cut for operation in toolpath.operations)
        with self.ledger.entry("simulation"):
            return side_flaws(job(self, cuts, toolpath_runs(toolpath), tolerance, ahead=False))[-1]

    def engaged(self, toolpath: Toolpath) -> tuple[OperationEngagement, ...]:
        """The engagement of the cutter in each roughing operation of a program, with places as the
        work lies.

        On the second side it is an upper bound, as if the first side had left all of the blank.
        """
        from camgeo.milling.milling import mirrored
        from camgeo.milling.plan import program_engagements

        part, spec = self.part, self.spec
        assert spec is not None  # for there is a program
        with self.ledger.entry("engagement"):
            operations = program_engagements(toolpath, part, spec)
        return tuple(
            replace(operation, place=mirrored(operation.place, spec.turned))
            for operation in operations
        )

    def findings(self, toolpath: Toolpath, tolerance: float) -> tuple[Finding, ...]:
        """The findings on the sequence, its programs and their simulation; "broken" if a program
        must not be run.
        """
        from camgeo.milling.judged import feature_findings

        program_findings = (
            *feature_findings(compared(self)),
            *(flaw.finding for flaw in self.flaws(toolpath, tolerance)),
        )
        # A finding of planning is left out where the simulation reports one of the same name.
        names = {finding.name for finding in program_findings}
        notes = [finding for finding in self.sequence.findings if finding.name not in names]
        if low := self._low_change():
            notes.append(Finding("tool-change-height", "warning", low))
        if len(self._groups) > 1:
            tools = ", ".join(str(group[0].tool.number) for group in self._groups)
            sentence = (
                f"the machine cannot change tools, so there are {len(self._groups)} programs, for"
                f" the tools {tools}"
            )
            notes.append(Finding("programs", "warning", sentence))
        return findings_in_unit(self.scene.unit, (*notes, *program_findings))

    def _low_change(self) -> str:
        """A warning that tools are changed close above the part though no height has been stated
        for that; empty if they are not.
        """
        from camgeo.milling.machine import load

        spec = self.gcode
        machine = load(spec.machine)
        several = any(len({cut.tool.number for cut in group}) > 1 for group in self._groups)
        if not (several and machine.retract.is_a_height and spec.tool_change_height is None):
            return ""
        return (
            f"tools are changed at the clearance height, Z {spec.clearance_height:g} mm, unless the"
            " machine moves away by itself; output.gcode.tool_change_height states another"
        )

    def safe(self, toolpath: Toolpath, tolerance: float) -> tuple[Finding, ...]:
        """The findings to be watched in a program; raises UnsafeError if it must not be run."""
        findings = self.findings(toolpath, tolerance)
        if wrong := "; ".join(
            finding.sentence for finding in findings if finding.severity == "broken"
        ):
            raise UnsafeError(f"the milling program must not be run: {wrong}", key="output.gcode")
        return tuple(finding for finding in findings if finding.severity != "ok")


def compared(milled: MilledDisc) -> tuple[Feature, ...]:
    """The features of the part, each compared with the operations of all sides of its job.

    Empty for a second side, whose operations are compared with those of the first one.
    """
    from camgeo.milling.judged import Side, compare_features

    first = milled if milled.whole is None else milled.whole
    if first.first is not None or first.spec is None:
        return ()
    sides = [Side(first.part, first.spec, first.sequence.cuts, ())]
    if first.second is not None:
        try:
            second, cuts = first.second.spec, first.second.sequence.cuts
        except SceneError:  # which the findings on that side report
            second, cuts = first.spec.of_second_side(faced=False, finished_walls=frozenset()), ()
        assert second is not None  # for there is that side
        sides.append(Side(first.second.part, second, cuts, ()))
    keyway = None if first.disc.spec is None else first.disc.spec.keyway
    return compare_features(first.disc.part, keyway, sides)


def job(
    milled: MilledDisc,
    cuts: tuple[Cut, ...],
    runs: tuple[ToolRun, ...],
    tolerance: float,
    *,
    level: float | None = None,
    allowed: float | None = None,
    ahead: bool = True,
) -> tuple[SimulatedSide, ...]:
    """The sides of a disc simulated, where `milled`, one of them, runs `runs` for its `cuts`, and
    the other what is planned for it, within `tolerance` [mm].

    Parameters
    ----------
    level, allowed : as for `camgeo.milling.simulation.simulate`; by default the tolerance is
        allowed in addition to what is allowed there.
    ahead : whether a side that follows is simulated too.
    """
    from camgeo.milling.judged import Side, simulate_sides, toolpath_runs
    from camgeo.milling.simulation import ALLOWED, LEVEL

    assert milled.spec is not None  # for there is a program
    density = None if milled.scene.part is None else milled.scene.part.density
    sides = [Side(milled.part, milled.spec, cuts, runs, density)]
    other = milled.second if milled.first is None else milled.first
    if other is not None and (ahead or other is milled.first):
        assert other.spec is not None  # likewise
        planned = toolpath_runs(other.toolpath(tolerance))
        side = Side(other.part, other.spec, other.sequence.cuts, planned, density)
        sides = [side, *sides] if other is milled.first else [*sides, side]
    return simulate_sides(
        sides,
        allowed=ALLOWED + tolerance if allowed is None else allowed,
        level=LEVEL if level is None else level,
        side_count=1 if other is None else 2,
    )
