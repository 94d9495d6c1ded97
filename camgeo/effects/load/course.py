"""Loads over the cam angle: one value, one for each stretch, or straight lines between rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from camgeo.effects.effect import DataFile
from camgeo.motion.motion import Side
from camgeo.motion.piece import SNAP
from camgeo.motion.plan import in_turn
from camgeo.motion.two_columns import ANGLE, Column, read_two_columns, turn_of
from camgeo.numeric.arrays import FloatArray, frozen

LOAD: Final = Column("load", ("f", "force", "load", "m", "t", "torque"), ("n", "nm", "n m"))


class Course(Protocol):
    """A load over the cam angle, in the unit of the scene.

    `borders` (k,) are cam angles [rad] in [0, 2 pi) where it may jump or bend.
    """

    @property
    def borders(self) -> FloatArray: ...

    def values(self, phi: FloatArray, side: Side) -> FloatArray: ...


@dataclass(frozen=True, slots=True)
class Constant:
    """The same load at all cam angles."""

    value: float

    @property
    def borders(self) -> FloatArray:
        return np.empty(0)

    def values(self, phi: FloatArray, side: Side) -> FloatArray:
        return np.full(len(phi), self.value)


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """A load for each stretch of the turn: `starts` (k,) [rad], ascending from 0, and `each` (k,).

    At a start the side decides which of two stretches counts.
    """

    starts: FloatArray
    each: FloatArray

    @property
    def borders(self) -> FloatArray:
        return self.starts

    def values(self, phi: FloatArray, side: Side) -> FloatArray:
        angle = in_turn(phi, side) + (SNAP if side == "right" else -SNAP)
        number = np.searchsorted(self.starts, angle, side=side) - 1
        found: FloatArray = self.each[np.maximum(number, 0)]
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Straight lines between rows: `angles` (n,) [rad] from 0 to 2 pi, and `loads` (n,).

    Where the last load is not the first one it jumps at cam angle 0. `unit` is that of the loads as
    the heading tells it, "N" or "N m"; empty where it does not.
    """

    angles: FloatArray
    loads: FloatArray
    unit: str = ""

    @property
    def borders(self) -> FloatArray:
        return self.angles[:-1]

    def values(self, phi: FloatArray, side: Side) -> FloatArray:
        found: FloatArray = np.interp(in_turn(phi, side), self.angles, self.loads)
        return found


def read_load_table(file: DataFile) -> Table:
    """The rows of `file`: cam angle [degrees] and load.

    It is written as `camgeo.motion.two_columns` tells; a heading may call the columns "phi",
    "angle" or "cam angle" [deg], and "F", "force", "load", "M", "T" or "torque" [N or Nm].

    Raises
    ------
    GeometryError
        With file and line, if a row is not as said there, or the angles do not ascend from 0 to
        360 degrees.
    """
    rows = read_two_columns(file.data, file.name, (ANGLE, LOAD))
    angles = turn_of(rows, rows.first)
    unit = {"n": "N", "nm": "N m", "n m": "N m"}.get(rows.unit.lower(), "")
    return Table(frozen(angles, np.float64), frozen(rows.second, np.float64), unit)
