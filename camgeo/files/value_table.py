"""The value table of a design: motion, curves, transmission angle and curvature over a turn."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Protocol

import numpy as np

from camgeo.files.table import Table
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray
from camgeo.units import LengthUnit

FULL_TURN = Decimal(360)


class Tabulated(Protocol):
    """What the table reads of a design."""

    @property
    def unit(self) -> LengthUnit: ...

    @property
    def millimetres(self) -> float: ...

    @property
    def lift_unit(self) -> str: ...

    @property
    def has_linkage(self) -> bool: ...

    def stroke(self, phi: FloatArray) -> Jet: ...

    def lift(self, phi: FloatArray) -> Jet: ...

    def pitch(self, phi: FloatArray) -> FloatArray: ...

    def inner(self, phi: FloatArray) -> FloatArray: ...

    def outer(self, phi: FloatArray) -> FloatArray: ...

    def curvature(self, phi: FloatArray) -> FloatArray: ...

    def radius_of_curvature(self, phi: FloatArray) -> FloatArray: ...

    def transmission_angle(self, phi: FloatArray) -> FloatArray: ...


def cam_angles(step: Decimal) -> FloatArray:
    """0, step, 2 step, ... below 360 [degrees], each rounded once from the exact decimal.

    A float that is counted up would arrive at 359.999999999988 after 1,800 steps of 0.2 and give
    one row too many.
    """
    count = math.ceil(FULL_TURN / step)
    return np.array([float(step * k) for k in range(count)])


def value_table(design: Tabulated, step: Decimal) -> Table:
    """One row for every `step` degrees of cam angle; right-hand values at the joints."""
    degrees = cam_angles(step)
    phi = np.radians(degrees)
    unit, mm = design.unit, design.millimetres
    columns: list[tuple[str, FloatArray]] = [("phi [deg]", degrees)]
    marks = ("", "'", "''", "'''")
    if design.has_linkage or design.lift_unit == "mm":
        per = ("", "/rad", "/rad^2", "/rad^3")
        for mark, rate, values in zip(marks, per, design.stroke(phi), strict=True):
            columns.append((f"s{mark} [{unit}{rate}]", values / mm))
    if design.lift_unit == "rad":
        swing = design.lift(phi)
        columns.append(("psi [deg]", np.degrees(swing[0])))
        for mark, rate, values in zip(marks[1:], ("1", "1/rad", "1/rad^2"), swing[1:], strict=True):
            columns.append((f"psi{mark} [{rate}]", values))
    for name, points in (
        ("pitch", design.pitch(phi)),
        ("inner", design.inner(phi)),
        ("outer", design.outer(phi)),
    ):
        columns.append((f"{name} x [{unit}]", points[:, 0] / mm))
        columns.append((f"{name} y [{unit}]", points[:, 1] / mm))
    columns.append(("mu [deg]", np.degrees(design.transmission_angle(phi))))
    columns.append((f"kappa [1/{unit}]", design.curvature(phi) * mm))
    columns.append((f"r_K [{unit}]", design.radius_of_curvature(phi) / mm))
    names = tuple(name for name, _ in columns)
    return Table(names, np.column_stack([values for _, values in columns]))
