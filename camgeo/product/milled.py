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
    from camgeo.toolpath.cut import ContourCut
    from camgeo.toolpath.moves import Toolpath


@dataclass(frozen=True)
class MilledDisc(Pickled):
    """A disc as seen by milling programs.

    Attributes
    ----------
    drawn : the disc to be milled.
    options : include tool, feeds and machine.
    values : of the scene; what milling needs may be missing.
    ledger : records what was computed.
    """

    drawn: DrawnDisc
    options: Options
    values: Values
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @lazy
    def cuts(self) -> tuple[ContourCut, ...]:
        """The exact cuts; GeometryError if the scene lacks what milling needs."""
        from camgeo.toolpath.sequence import cuts_of

        if lacking := FORMAT.lacking(self.values):
            raise GeometryError(f"milling {'; '.join(lacking)}", key="output.gcode")
        spec = self.options[FORMAT]
        return cuts_of(self.drawn.part, spec.tool, spec.pass_depth)

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter paths."""
        from camgeo.toolpath.machine import load
        from camgeo.toolpath.moves import Heights
        from camgeo.toolpath.plan import plan_toolpath

        cuts, spec, effort = self.cuts, self.options[FORMAT], self.drawn.effort
        limits, heights = load(spec.machine).arcs, Heights.of(spec.safe_height)
        return self.ledger.run(
            "toolpath", lambda: plan_toolpath(cuts, heights, limits, tolerance, effort)
        )
