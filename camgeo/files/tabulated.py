"""A cam as value tables tell it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from typing import TYPE_CHECKING

from camgeo.formats.csv import CsvSpec
from camgeo.lazy import Ledger
from camgeo.pickled import Pickled
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.cam.drive import Drive, LiftUnit
    from camgeo.effects.effect import Column
    from camgeo.files.value_table import Table


@dataclass(frozen=True)
class TabulatedCam(Pickled):
    """What tables tell of a cam.

    Attributes
    ----------
    drive : what moves the follower.
    lift_unit : of the follower's own motion.
    cam : the cam; None if there is no follower.
    unit : of lengths in the table.
    spec : the step of the table.
    columns : gives the effects over the cam angle.
    ledger : where it is entered what was computed.
    """

    drive: Drive
    lift_unit: LiftUnit
    cam: Cam | None
    unit: LengthUnit
    spec: CsvSpec
    columns: Callable[[], tuple[Column, ...]]
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def table(self, step: Decimal | None = None) -> Table:
        """The value table, in the scene's unit and degrees, at every `step` or at the scene's."""
        from camgeo.files.value_table import value_table

        spec = self.spec if step is None else CsvSpec(step)
        moved = self.drive, self.lift_unit
        return self.ledger.run(
            "table", lambda: value_table(*moved, self.cam, self.unit, self.columns(), spec.step)
        )
