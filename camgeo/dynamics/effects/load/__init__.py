"""Effect `load`: the process force over the cam angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from camgeo.dynamics.effects.effect import DataFile, Effect, Quantity
from camgeo.dynamics.effects.results import LOAD
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import in_turn
from camgeo.kinematics.tables import ANGLE, read_two_columns, turn_of
from camgeo.numeric.arrays import FloatArray, Side, frozen
from camgeo.numeric.columns import NumberColumn
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.load]``: the process load, in exactly one of three ways.


KINDS: Final = ("constant", "segments", "file")


def parse(table: Mapping[str, Any]) -> LoadProfile | Sequence[float]:
    """The load over the cam angle; if it is given by segments, one value [N or N m] for each of
    non-zero length.

    Raises
    ------
    GeometryError
        If not exactly one of the keys is given; with key "file", if the file does not have the
        format in the schema, with angles that ascend from 0 to 360 degrees.
    """
    given = [key for key in KINDS if key in table]
    if len(given) != 1:
        found = " and ".join(given) if given else "none"
        raise GeometryError(
            f"exactly one of {', '.join(KINDS)} is needed, and the scene gives {found}",
            key=given[1] if given else "",
        )
    if "segments" in table:
        segments: Sequence[float] = table["segments"]
        return segments
    if "constant" in table:
        constant = table["constant"]
        return LoadProfile(lambda phi, _side: np.full(len(phi), constant))
    try:
        return read_load_table(table["file"])
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error


# -- load -----------------------------------------------------------------------------------------


EFFECT: Final = Effect(
    name=LOAD,
    title="process load",
    compute="camgeo.dynamics.effects.load.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    tabled=True,
    premise="motion",
)


# -- profile --------------------------------------------------------------------------------------
# Loads over the cam angle: one value, one value per segment, or linear interpolation in a
# table.


LOAD_COLUMN: Final = NumberColumn(
    "load", ("f", "force", "load", "m", "t", "torque"), ("n", "nm", "n m"), "N or Nm"
)


@dataclass(frozen=True, slots=True, eq=False)
class LoadProfile:
    """A load over the cam angle, in the unit of the scene.

    Attributes
    ----------
    values : (n,) the load; at a border the side decides.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the load may jump or have a kink.
    unit : "N" or "N m" if the heading of a file states it, else empty.
    """

    values: Quantity
    borders: FloatArray = field(default_factory=lambda: np.empty(0))
    unit: str = ""


def read_load_table(file: DataFile) -> LoadProfile:
    """Linear interpolation between the rows of `file`: cam angle [degrees] and load.

    If the last load differs from the first one, the load jumps at cam angle 0.

    See `camgeo.numeric.columns` for the format; a heading may name the columns "phi", "angle" or
    "cam angle" [deg], and "F", "force", "load", "M", "T" or "torque" [N or Nm].

    Raises
    ------
    GeometryError
        With file and line, if a row does not have this format, or the angles do not ascend from 0
        to 360 degrees.
    """
    rows = read_two_columns(file.data, file.name, (ANGLE, LOAD_COLUMN))
    angles = turn_of(rows, rows.first)
    unit = {"n": "N", "nm": "N m", "n m": "N m"}.get(rows.unit.lower(), "")

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.interp(in_turn(phi, side), angles, rows.second)

    return LoadProfile(values, frozen(angles[:-1], np.float64), unit)
