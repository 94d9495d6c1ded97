"""A disc as drawings and solids show it: its part, and the pitch curve beside it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from camgeo.lazy import Ledger, lazy
from camgeo.part.spec import PartSpec
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.check.judge import Judgement
    from camgeo.contour.contour import Contour, Effort, Fit
    from camgeo.part.part import Part

TOPOLOGY_TOLERANCE = 0.01
"""Contours by which it is seen that a bore fits are this exact [mm]; their deviation is counted."""


@dataclass(frozen=True)
class DrawnDisc(Pickled):
    """What drawings and solids show of a disc.

    Attributes
    ----------
    cam : the cam whose disc it is.
    spec : what is asked of the part beyond the flanks; None asks for nothing.
    effort : how hard fits try.
    judgement : whether there is such a disc.
    ledger : where it is entered what was computed.
    """

    cam: Cam
    spec: PartSpec | None
    effort: Effort
    judgement: Judgement
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @property
    def base_radius(self) -> float:
        """r_G [mm]."""
        return self.cam.follower.base_radius

    @property
    def has_pitch_curve(self) -> bool:
        """False of a flat face, whose contact runs on the outline itself."""
        return self.cam.follower.has_pitch_curve

    @lazy
    def part(self) -> Part:
        """The part; GeometryError if it does not fit together, UndercutError if there is none."""
        from camgeo.part.build import build_part

        self.judgement.require_outline(self.cam)
        spec, paths = self.spec or PartSpec(), self.cam.disc.flank_paths
        return build_part(self.cam.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""
        from camgeo.contour.arcs.fast import fit_arcs
        from camgeo.contour.arcs.fewest import fewest_arcs

        fit = fit_arcs if self.effort == "fast" else fewest_arcs
        path = self.cam.disc.pitch_path
        return self.ledger.run("arcs of pitch curve", lambda: fit(path, tolerance))

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the pitch curve."""
        from camgeo.contour.proof.deviation import deviation

        return deviation(self.cam.disc.pitch_path, contour)
