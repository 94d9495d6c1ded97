"""A disc as drawings and solids show it: its part, and the pitch curve."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from camgeo.lazy import Ledger, built, lazy
from camgeo.part.spec import PartSpec
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.check.judge import Judgement
    from camgeo.contour.contour import Contour, Effort, Fit
    from camgeo.part.part import Part
    from camgeo.printing.spec import PrintSpec
    from camgeo.product.printed import PrintedDisc

TOPOLOGY_TOLERANCE = 0.01
"""Accuracy [mm] of the contours that show that a bore fits; their deviation is accounted for."""


@dataclass(frozen=True)
class DrawnDisc(Pickled):
    """What drawings and solids show of a disc.

    Attributes
    ----------
    cam : the cam that the disc belongs to.
    spec : specification of the part beyond the flanks; None for none.
    effort : how hard fits try.
    judgement : whether such a disc exists.
    ledger : records what was computed.
    printing : what the scene states on printing; None for nothing.
    returning : for a conjugate pair in one piece, whose main disc has `cam`, that of the return
        disc; else None.
    """

    cam: Cam
    spec: PartSpec | None
    effort: Effort
    judgement: Judgement
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    printing: PrintSpec | None = None
    returning: Cam | None = None

    @property
    def base_radius(self) -> float:
        """r_G [mm]."""
        return self.cam.follower.base_radius

    @property
    def has_pitch_curve(self) -> bool:
        """False for a flat face, whose contact point runs on the outline itself."""
        return self.cam.follower.has_pitch_curve

    @lazy
    def part(self) -> Part:
        """The part; GeometryError if it is inconsistent, UndercutError if none exists."""
        return self._built(self.spec or PartSpec())

    @property
    def untrimmed(self) -> Part:
        """The part between whole flanks, of which nothing is cut off, before it is known whether
        there is such a disc; GeometryError if it is inconsistent.
        """
        from camgeo.part.build import build_part

        paths, spec = self.cam.disc.untrimmed_paths, self.spec or PartSpec()
        return build_part(self.cam.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    def _part_by(self, spec: PartSpec) -> Part:
        """The part by another specification; raises like `part`."""
        return self.part if spec == (self.spec or PartSpec()) else self._built(spec)

    def _built(self, spec: PartSpec) -> Part:
        from camgeo.part.build import build_part

        self.judgement.require_outline(self.cam)
        paths = self.cam.disc.flank_paths
        if self.returning is not None:
            from camgeo.part.pair import build_pair  # few scenes have one

            self.judgement.require_outline(self.returning)
            both = (paths[0], self.returning.disc.flank_paths[0])
            return build_pair(both, spec, TOPOLOGY_TOLERANCE, self.ledger)
        return build_part(self.cam.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    @built
    def printed(self) -> PrintedDisc:
        """The disc as bodies for printing show it."""
        from camgeo.product.printed import PrintedDisc

        return PrintedDisc(self._part_by, self.spec or PartSpec(), self.printing, self.ledger)

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""
        from camgeo.contour.arcs.fast import fit_arcs
        from camgeo.contour.arcs.fewest import fewest_arcs

        fit = fit_arcs if self.effort == "fast" else fewest_arcs
        path = self.cam.disc.pitch_path
        return self.ledger.run("arcs of pitch curve", lambda: fit(path, tolerance))

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] on the distance between `contour` and the pitch curve."""
        from camgeo.contour.proof.deviation import deviation

        return deviation(self.cam.disc.pitch_path, contour)
