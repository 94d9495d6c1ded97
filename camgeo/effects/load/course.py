"""Loads over the cam angle: one value, one for each stretch, or straight lines between rows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.effects.effect import DataFile, Quantity
from camgeo.motion.motion import Side
from camgeo.motion.piece import SNAP
from camgeo.motion.plan import in_turn
from camgeo.motion.two_columns import ANGLE, Column, read_two_columns, turn_of
from camgeo.numeric.arrays import FloatArray, frozen

LOAD: Final = Column("load", ("f", "force", "load", "m", "t", "torque"), ("n", "nm", "n m"))


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A load over the cam angle, in the unit of the scene.

    Attributes
    ----------
    values : (n,) the load; at a border the side decides.
    borders : (k,) cam angles [rad] in [0, 2 pi) where it may jump or bend.
    unit : "N" or "N m", as the heading of a file tells it; empty where nothing does.
    """

    values: Quantity
    borders: FloatArray = field(default_factory=lambda: np.empty(0))
    unit: str = ""


def constant(value: float) -> Course:
    """The same load at all cam angles."""
    return Course(lambda phi, _side: np.full(len(phi), value))


def steps(starts: FloatArray, loads: FloatArray) -> Course:
    """A load for each stretch of the turn: `starts` (k,) [rad], ascending from 0, `loads` (k,)."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        angle = in_turn(phi, side) + (SNAP if side == "right" else -SNAP)
        found: FloatArray = loads[np.maximum(np.searchsorted(starts, angle, side=side) - 1, 0)]
        return found

    return Course(values, starts)


def read_load_table(file: DataFile) -> Course:
    """Straight lines between the rows of `file`: cam angle [degrees] and load.

    Where the last load is not the first one it jumps at cam angle 0.

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

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.interp(in_turn(phi, side), angles, rows.second)

    return Course(values, frozen(angles[:-1], np.float64), unit)
