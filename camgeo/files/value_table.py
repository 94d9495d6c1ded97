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
    from camgeo.files.product import Demanded

FULL_TURN = Decimal(360)

POWERS = ("s", "s^2", "s^3")

MARKS = ("", "'", "''", "'''")
"""Of a motion and its derivatives over the cam angle."""

ANGLES: dict[Demanded, str] = {"lever": "chi", "crank": "theta"}
"""What a demanded angle is called that is not the follower's own."""

SWING = ("omega", "alpha", "j")
"""How the names of angular velocity, acceleration and jerk begin."""


class Tabulated(Protocol):
    """What the table reads of a design."""

    @property
    def unit(self) -> LengthUnit: ...

    @property
    def millimetres(self) -> float: ...

    @property
    def lift_unit(self) -> str: ...

    @property
    def demanded_of(self) -> Demanded: ...

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
    for name, motion in _motions(design, phi):
        columns += _angle(name, motion) if name else _length(design, motion)
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


def _motions(design: Tabulated, phi: FloatArray) -> list[tuple[str, Jet]]:
    """The motion that the scene demands, and the follower's own if that is another one.

    Each (4, n) behind the name of its angle, empty for a way.
    """
    own = "psi" if design.lift_unit == "rad" else ""
    found = [(own, design.lift(phi))]
    if design.demanded_of != "follower":
        found.insert(0, (ANGLES.get(design.demanded_of, ""), design.stroke(phi)))
    return found


def _length(design: Tabulated, motion: Jet) -> list[tuple[str, FloatArray]]:
    return [
        (f"s{mark} [{design.unit}{rate}]", values / design.millimetres)
        for mark, rate, values in zip(MARKS, ("", "/rad", "/rad^2", "/rad^3"), motion, strict=True)
    ]


def _angle(name: str, motion: Jet) -> list[tuple[str, FloatArray]]:
    rates = zip(MARKS[1:], ("1", "1/rad", "1/rad^2"), motion[1:], strict=True)
    return [
        (f"{name} [deg]", np.degrees(motion[0])),
        *((f"{name}{mark} [{rate}]", values) for mark, rate, values in rates),
    ]


def _in_time(design: Tabulated, phi: FloatArray) -> list[tuple[str, FloatArray]]:
    """Time and derivatives in time: of the motion that the scene demands, and of the follower."""
    course = design.time_course
    if course is None:
        return []
    columns = [("t [s]", course.time(phi))]
    for name, motion in _motions(design, phi):
        timed = in_time(motion, course, phi)[1:]
        if name:
            for kind, power, values in zip(SWING, POWERS, timed, strict=True):
                columns.append((f"{kind}_{name} [deg/{power}]", np.degrees(values)))
            continue
        for kind, power, values in zip(("v", "a", "j"), POWERS, timed, strict=True):
            columns.append((f"{kind} [{design.unit}/{power}]", values / design.millimetres))
    return columns


def _of_effect(design: Tabulated, column: Column, phi: FloatArray) -> tuple[str, FloatArray]:
    """Heading and values of an effect's column, lengths in the unit of the scene."""
    unit, values = column.unit, column.values(phi, "right")
    if unit == "mm" or unit.startswith("mm/"):
        unit, values = design.unit + unit.removeprefix("mm"), values / design.millimetres
    return f"{column.name} [{unit}]" if unit else column.name, values
