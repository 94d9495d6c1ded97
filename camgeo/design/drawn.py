"""A disc as drawings and solids show it: its part, and the pitch curve."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger, built, lazy
from camgeo.part.spec import PartSpec
from camgeo.record import Pickled

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.cam.cam import Cam
    from camgeo.check.judge import Judgement
    from camgeo.geometry.contour.contour import Contour, Effort, Fit
    from camgeo.part.compensation import PrintSpec
    from camgeo.part.part import Part


TOPOLOGY_TOLERANCE = 0.01
"""Accuracy [mm] of the contours that show that a bore fits; their deviation is accounted for."""


@dataclass(frozen=True)
class DrawnDisc(Pickled):
    """What drawings and solids show of a disc.

    Attributes
    ----------
    cam : the cam that the disc belongs to.
    spec : specification of the part beyond the flanks; None for none.
    effort : effort of the fits.
    judgement : the findings, which decide whether such a disc exists.
    ledger : records what was computed.
    printing : the scene's specification of printing; None if it has none.
    returning : for a conjugate pair in one piece, whose main disc has `cam`, the cam of the return
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
        """The part between whole flanks, of which nothing is cut off, whether or not there is such
        a disc; GeometryError if it is inconsistent.
        """
        from camgeo.part.assembly import build_part

        paths, spec = self.cam.disc.untrimmed_paths, self.spec or PartSpec()
        return build_part(self.cam.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    def _specified_part(self, spec: PartSpec) -> Part:
        """The part by the specification `spec`; raises like `part`."""
        return self.part if spec == (self.spec or PartSpec()) else self._built(spec)

    def _built(self, spec: PartSpec) -> Part:
        from camgeo.part.assembly import build_part

        self.judgement.require_outline(self.cam)
        paths = self.cam.disc.flank_paths
        if self.returning is not None:
            from camgeo.part.assembly import build_pair  # few scenes have one

            self.judgement.require_outline(self.returning)
            both = (paths[0], self.returning.disc.flank_paths[0])
            return build_pair(both, spec, TOPOLOGY_TOLERANCE, self.ledger)
        return build_part(self.cam.contact, *paths, spec, TOPOLOGY_TOLERANCE, self.ledger)

    @built
    def printed(self) -> PrintedDisc:
        """The disc as bodies for printing show it."""
        return PrintedDisc(
            self._specified_part, self.spec or PartSpec(), self.printing, self.ledger
        )

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""
        from camgeo.geometry.contour.arcs import fewest_arcs, fit_arcs

        fit = fit_arcs if self.effort == "fast" else fewest_arcs
        path = self.cam.disc.pitch_path
        with self.ledger.entry("arcs of pitch curve"):
            return fit(path, tolerance)

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] on the distance between `contour` and the pitch curve."""
        from camgeo.geometry.contour.proof import deviation

        return deviation(self.cam.disc.pitch_path, contour)


# -- printed --------------------------------------------------------------------------------------
# A disc as printed bodies show it: its part, compensated as the scene asks.


COMPENSATED: Final = "print-compensation"
"""Name of the finding on a body that differs from the part, as it is compensated."""

SLICER_ADVICE: Final = (
    "switch off the slicer's own: elephant foot compensation, XY and hole compensation, shrinkage"
)
"""What has to be done by whoever prints a compensated body."""


@dataclass(frozen=True)
class PrintedDisc(Pickled):
    """What files of solid bodies for printing show of a disc.

    Attributes
    ----------
    make_part : returns the part by a specification.
    stated : the scene's specification of the part.
    spec : the scene's specification of printing; None if it has none.
    ledger : records what was computed.
    """

    make_part: Callable[[PartSpec], Part]
    stated: PartSpec
    spec: PrintSpec | None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @lazy
    def fitted(self) -> Part:
        """The part with the clearances of bore and key; GeometryError with the key in `print` if it
        has no room for them.
        """
        part = self.make_part(self.stated)  # so that faults of the part itself are raised first
        if self.spec is None:
            return part
        wider = self.spec.with_clearance(self.stated)
        try:
            return self.make_part(wider)
        except GeometryError as error:
            raise self.spec.fault_of_clearance(error) from None

    @lazy
    def target(self) -> Part:
        """The part as the file has it, compensated; raises like `fitted`, or if what the scene asks
        for is impossible.
        """
        if self.spec is None or not self.spec.compensates:
            return self.fitted
        from camgeo.part.compensation import compensate_part

        return compensate_part(self.fitted, self.spec)

    @property
    def facts(self) -> dict[str, int | float | str]:
        """The compensation as certificates state it; empty if there is none."""
        if self.spec is None or not self.spec.compensates:
            return {}
        return {**self.spec.facts, "compensation": self.advice}

    @property
    def text(self) -> str:
        """The compensation in words; empty if there is none."""
        return "" if self.spec is None else self.spec.text

    @property
    def advice(self) -> str:
        """The compensation in words, and what to do when printing; empty if there is none."""
        return self.text and f"{self.text}; {SLICER_ADVICE}"

    def findings(self, file: str) -> tuple[Finding, ...]:
        """The finding that says what to watch when printing `file`; none if nothing."""
        if not self.text:
            return ()
        sentence = f"{file} is compensated for printing ({self.text}): {SLICER_ADVICE}"
        return (Finding(COMPENSATED, "warning", sentence),)
