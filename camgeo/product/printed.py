"""A disc as printed bodies show it: its part, compensated as the scene asks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger, lazy
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.part.part import Part
    from camgeo.part.spec import PartSpec
    from camgeo.printing.spec import PrintSpec

COMPENSATED: Final = "print-compensation"
"""Name of the finding on a body that is not the part."""

SWITCH_OFF: Final = (
    "switch off the slicer's own: elephant foot compensation, XY and hole compensation, shrinkage"
)
"""What whoever prints such a body has to do."""


@dataclass(frozen=True)
class PrintedDisc(Pickled):
    """What files of solid bodies for printing show of a disc.

    Attributes
    ----------
    part_by : the part by a specification.
    stated : the specification of the part in the scene.
    spec : what the scene states on printing; None for nothing.
    ledger : records what was computed.
    """

    part_by: Callable[[PartSpec], Part]
    stated: PartSpec
    spec: PrintSpec | None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @lazy
    def fitted(self) -> Part:
        """The part with the clearances of bore and key; GeometryError with the key in `print` if it
        has no room for them.
        """
        part = self.part_by(self.stated)  # whose own faults come first
        if self.spec is None:
            return part
        from camgeo.printing.compensation import fault_of_clearance, with_clearance

        wider = with_clearance(self.stated, self.spec)
        try:
            return self.part_by(wider)
        except GeometryError as error:
            raise fault_of_clearance(self.spec, error) from None

    @lazy
    def target(self) -> Part:
        """The part as the file has it, compensated; raises like `fitted`, or if what the scene asks
        for is impossible.
        """
        if self.spec is None or not self.spec.compensates:
            return self.fitted
        from camgeo.printing.compensation import compensated

        return compensated(self.fitted, self.spec)

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
        """The compensation in words, and what whoever prints has to do; empty if there is none."""
        return self.text and f"{self.text}; {SWITCH_OFF}"

    def findings(self, file: str) -> tuple[Finding, ...]:
        """What whoever prints the `file` has to watch."""
        if not self.text:
            return ()
        sentence = f"{file} is compensated for printing ({self.text}): {SWITCH_OFF}"
        return (Finding(COMPENSATED, "warning", sentence),)
