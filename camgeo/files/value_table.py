"""The value table of a design: motion, curves, transmission angle and curvature over a turn."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Protocol

import numpy as np

from camgeo.files.table import Table
from camgeo.motion.motion import Jet
from camgeo.motion.time_course import TimeCourse, in_time
from camgeo.numeric.arrays import FloatArray
from camgeo.units import LengthUnit

if TYPE_CHECKING:  # few scenes name an effect
    from camgeo.effects.effect import Column

FULL_TURN = Decimal(360)

POWERS = ("s", "s^2", "s^3")

SWING = ("omega_psi", "alpha_psi", "j_psi")
"""Names of the rocker's angular velocity, acceleration and jerk."""


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

    @property
    def is_flat(self) -> bool: ...

    def contact_place(self, phi: FloatArray) -> FloatArray: ...

    def stroke(self, phi: FloatArray) -> Jet: ...

    def lift(self, phi: FloatArray) -> Jet: ...

    def pitch(self, phi: FloatArray) -> FloatArray: ...

    def inner(self, phi: FloatArray) -> FloatArray: ...

    def outer(self, phi: FloatArray) -> FloatArray: ...

    def curvature(self, phi: FloatArray) -> FloatArray: ...

    def radius_of_curvature(self, phi: FloatArray) -> FloatArray: ...

    def transmission_angle(self, phi: FloatArray) -> FloatArray: ...

    @property
    def time_course(self) -> TimeCourse | None: ...

    @property
    def effect_columns(self) -> tuple[Column, ...]: ...


def cam_angles(step: Decimal) -> FloatArray:
    """0, step, 2 step, ... below 360 [degrees], each rounded once from the exact decimal.

    A float that is counted up would arrive at 359.999999999988 after 1,800 steps of 0.2 and give
    one row too many.
    """
    count = math.ceil(FULL_TURN / step)
    return np.array([float(step * k) for k in range(count)])


def value_table(design: Tabulated, step: Decimal) -> Table:
    """One row for every `step` degrees of cam angle; right-hand values at the joints.

    With a speed also the time, and velocity, acceleration and jerk in time; then the effects that
    the scene calls for. A flat face has one curve, the outline on which its contact runs, and the
    place of the contact on the face.
    """
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
    columns += _in_time(design, phi)
    curves = [("contact", design.pitch(phi))]
    if not design.is_flat:
        curves = [
            ("pitch", design.pitch(phi)),
            ("inner", design.inner(phi)),
            ("outer", design.outer(phi)),
        ]
    for name, points in curves:
        columns.append((f"{name} x [{unit}]", points[:, 0] / mm))
        columns.append((f"{name} y [{unit}]", points[:, 1] / mm))
    if design.is_flat:
        columns.append((f"on face [{unit}]", design.contact_place(phi) / mm))
    columns.append(("mu [deg]", np.degrees(design.transmission_angle(phi))))
    columns.append((f"kappa [1/{unit}]", design.curvature(phi) * mm))
    columns.append((f"r_K [{unit}]", design.radius_of_curvature(phi) / mm))
    columns += [_of_effect(design, column, phi) for column in design.effect_columns]
    names = tuple(name for name, _ in columns)
    return Table(names, np.column_stack([values for _, values in columns]))


def _in_time(design: Tabulated, phi: FloatArray) -> list[tuple[str, FloatArray]]:
    """Time and derivatives in time: of the motion that the scene demands, and of the rocker."""
    course = design.time_course
    if course is None:
        return []
    columns = [("t [s]", course.time(phi))]
    if design.has_linkage or design.lift_unit == "mm":
        timed = in_time(design.stroke(phi), course, phi)[1:]
        for name, power, values in zip(("v", "a", "j"), POWERS, timed, strict=True):
            columns.append((f"{name} [{design.unit}/{power}]", values / design.millimetres))
    if design.lift_unit == "rad":
        timed = in_time(design.lift(phi), course, phi)[1:]
        for name, power, values in zip(SWING, POWERS, timed, strict=True):
            columns.append((f"{name} [deg/{power}]", np.degrees(values)))
    return columns


def _of_effect(design: Tabulated, column: Column, phi: FloatArray) -> tuple[str, FloatArray]:
    """Heading and values of an effect's column, lengths in the unit of the scene."""
    unit, values = column.unit, column.values(phi, "right")
    if unit == "mm" or unit.startswith("mm/"):
        unit, values = design.unit + unit.removeprefix("mm"), values / design.millimetres
    return f"{column.name} [{unit}]" if unit else column.name, values
