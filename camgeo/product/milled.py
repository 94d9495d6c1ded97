"""A disc as milling programs cut it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from camgeo.errors import GeometryError
from camgeo.formats.gcode import FORMAT
from camgeo.lazy import Ledger, lazy
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.formats.format import Options, Values
    from camgeo.product.drawn import DrawnDisc
    from camgeo.toolpath.cut import ContourCut, Cut
    from camgeo.toolpath.milling import MillingSpec
    from camgeo.toolpath.moves import Toolpath
    from camgeo.toolpath.sequence import Sequence


@dataclass(frozen=True)
class MilledDisc(Pickled):
    """A disc as seen by milling programs.

    Attributes
    ----------
    drawn : the disc to be milled.
    options : include the machine and the heights of traverses.
    values : of the scene; what milling needs may be missing.
    spec : tools, blank, holding and operations; None if the scene says nothing on milling.
    ledger : records what was computed.
    """

    drawn: DrawnDisc
    options: Options
    values: Values
    spec: MillingSpec | None = None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @lazy
    def sequence(self) -> Sequence:
        """The exact cuts, and what is told of them; raises GeometryError if the scene lacks what
        milling needs, or its tools cannot do it.
        """
        from camgeo.toolpath.sequence import sequence_of

        if lacking := FORMAT.lacking(self.values):
            raise GeometryError(f"milling {'; '.join(lacking)}", key="output.gcode")
        assert self.spec is not None  # for the scene has a tool
        return sequence_of(self.drawn.part, self.spec, self.options[FORMAT].heights)

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """The exact cuts, in their order."""
        return self.sequence.cuts

    @property
    def contour_cuts(self) -> tuple[ContourCut, ...]:
        """Those along a closed path, by which programs are measured."""
        from camgeo.toolpath.cut import ContourCut

        return tuple(cut for cut in self.cuts if isinstance(cut, ContourCut))

    @property
    def told(self) -> tuple[str, ...]:
        """What is told of the sequence, a sentence each; raises like `sequence`."""
        return tuple(finding.sentence for finding in self.sequence.findings)

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.toolpath.machine import load
        from camgeo.toolpath.plan import plan_toolpath

        cuts, spec, effort = self.cuts, self.options[FORMAT], self.drawn.effort
        limits, heights = load(spec.machine).arcs, spec.heights
        return self.ledger.run(
            "toolpath", lambda: plan_toolpath(cuts, heights, limits, tolerance, effort)
        )
