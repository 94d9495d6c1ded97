"""What `camgeo slotted-lever` finds: the motion of a slotted lever at constant crank speed."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, ClassVar, Final

from camgeo.answers.answer import Answer
from camgeo.errors import GeometryError
from camgeo.mechanism.slotted_lever import SlottedLever
from camgeo.mechanism.slotted_lever_drive import NAMES, DrivenLever, crank_for_swing, lever_table
from camgeo.units import RPM

if TYPE_CHECKING:  # few calls request a table
    from camgeo.product.value_table import Table

LOWEST, HIGHEST = 1e-100, 1e100
"""Of lengths [mm] and speeds [rev/min]: results computed from them are far from overflow."""

Number = float | Decimal

Rows = tuple[Decimal, Decimal, Decimal]
"""Step, first and last crank angle of a table [deg]."""

FULL_TURN: Final[Rows] = (Decimal(1), Decimal(0), Decimal(360))
"""Those of the table of the SAM exercise."""


@dataclass(frozen=True, slots=True)
class LeverMotion(Answer):
    """The lever and its motion.

    Attributes
    ----------
    driven : the lever with the speed of its crank; has extremes and strokes.
    table : values over the crank angle, in degrees; None if it was not requested.
    """

    command: ClassVar[str] = "slotted-lever"

    driven: DrivenLever
    table: Table | None = None

    @property
    def swing(self) -> float | None:
        """Angle between the end positions [rad]; None for a lever that makes full turns."""
        lever = self.driven.lever
        return 2.0 * lever.largest_angle.value if lever.swings else None

    @property
    def time_ratio(self) -> float | None:
        """Duration of the slow stroke over that of the quick one; None if there are no strokes."""
        lever = self.driven.lever
        return lever.time_ratio if lever.swings else None


def slotted_lever(
    frame: Number,
    speed: Number,
    *,
    crank: Number | None = None,
    swing: Number | None = None,
    rows: Rows | None = None,
    printed: bool = False,
) -> LeverMotion:
    """Compute the motion of a slotted lever.

    Parameters
    ----------
    frame : distance of the axes of crank and lever [mm].
    speed : of the crank [rev/min].
    crank, swing : its radius [mm], or the whole swing of the lever [deg]; one of them.
    rows : of the table, `FULL_TURN` for that of the exercise; None for no table.
    printed : whether the table is rounded to three decimals, as the exercise prints it.

    Raises
    ------
    GeometryError
        With the name of the parameter as its key, of `rows` "step", "from" or "to".
    """
    distance = _checked("frame", frame, "mm")
    if swing is not None:
        radius = crank_for_swing(distance, float(swing))
        if radius < LOWEST:
            message = f"makes a crank of {radius:g} mm; at least {LOWEST:g} mm is allowed"
            raise GeometryError(message, key="swing", value=str(swing))
    elif crank is not None:
        radius = _checked("crank", crank, "mm")
    else:
        raise GeometryError("is needed, or the swing", key="crank")
    driven = DrivenLever(SlottedLever(radius, distance), _checked("speed", speed, "rev/min") * RPM)
    return LeverMotion(driven, None if rows is None else _table(driven, rows, printed))


def _checked(key: str, given: Number, unit: str) -> float:
    value = float(given)
    if not LOWEST <= value <= HIGHEST:
        message = f"must be from {LOWEST:g} to {HIGHEST:g} {unit}"
        raise GeometryError(message, key=key, value=str(given))
    return value


def _table(driven: DrivenLever, rows: Rows, printed: bool) -> Table:
    from camgeo.product.value_table import Table

    found = lever_table(driven, *rows)
    return Table.rounded(NAMES, found.printed()) if printed else Table(NAMES, found.values)
