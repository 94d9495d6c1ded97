"""Loads over the cam angle: one value, one value per segment, or linear interpolation in a
table.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.effects.effect import DataFile, Quantity
from camgeo.motion.piece import SNAP
from camgeo.motion.plan import in_turn
from camgeo.motion.two_columns import ANGLE, read_two_columns, turn_of
from camgeo.numeric.arrays import FloatArray, Side, frozen
from camgeo.numeric.columns import Column

LOAD: Final = Column(
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


def constant(value: float) -> LoadProfile:
    """The same load at all cam angles."""
    return LoadProfile(lambda phi, _side: np.full(len(phi), value))


def steps(starts: FloatArray, loads: FloatArray) -> LoadProfile:
    """A load for each segment: `starts` (k,) [rad], ascending from 0, and `loads` (k,)."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        angle = in_turn(phi, side) + (SNAP if side == "right" else -SNAP)
        found: FloatArray = loads[np.maximum(np.searchsorted(starts, angle, side=side) - 1, 0)]
        return found

    return LoadProfile(values, starts)


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
    rows = read_two_columns(file.data, file.name, (ANGLE, LOAD))
    angles = turn_of(rows, rows.first)
    unit = {"n": "N", "nm": "N m", "n m": "N m"}.get(rows.unit.lower(), "")

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.interp(in_turn(phi, side), angles, rows.second)

    return LoadProfile(values, frozen(angles[:-1], np.float64), unit)
