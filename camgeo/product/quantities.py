"""The quantities over the cam angle that a value table has, each computed when it is called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.cam.disc import Disc
from camgeo.cam.drive import Demanded, Drive
from camgeo.curve.extremes import radius_of_curvature
from camgeo.motion.motion import Jet
from camgeo.motion.time_course import in_time
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.outline.convex import touch
from camgeo.units import MM_PER, LengthUnit, LiftUnit, unit_in

if TYPE_CHECKING:  # few scenes name an effect
    from camgeo.curve.pitch_curve import PitchCurve
    from camgeo.effects.effect import Column
    from camgeo.motion.time_course import TimeCourse

POWERS = ("s", "s^2", "s^3")

MARKS = ("", "'", "''", "'''")
"""Units of a motion's derivatives over the cam angle."""

ANGLES: dict[Demanded, str] = {"lever": "chi", "crank": "theta"}
"""Name of a prescribed angle that is not the follower's own."""

Quantity = Callable[[FloatArray, Side], FloatArray]
"""(n,) values at n cam angles [rad], approached from the given side."""

JetOfMotion = Callable[[FloatArray, Side], Jet]
"""(4, n) a motion and its derivatives, likewise."""

Value = TypeVar("Value", FloatArray, ComplexArray)

Columns = list[tuple[str, Quantity]]
"""Headings, each with what gives its values."""

SWING = ("omega", "alpha", "j")
"""Prefixes of the names of angular velocity, acceleration and jerk."""

TIMED = ("v", "a", "j")
"""Names of velocity, acceleration and jerk."""


def quantities(drive: Drive, lift_unit: LiftUnit, cam: Cam | None, unit: LengthUnit) -> Columns:
    """What a value table has beside the cam angle and effects, its lengths in `unit`.

    Right and left values differ where something jumps, which is at borders of the motion only.
    """
    columns = quantities_of_drive(drive, lift_unit, unit)
    return columns if cam is None else columns + quantities_of_disc(cam.disc, unit)


def quantities_of_drive(drive: Drive, lift_unit: LiftUnit, unit: LengthUnit) -> Columns:
    """Motions over the cam angle and in time."""
    motions = _motions(drive, lift_unit)
    columns: Columns = []
    for name, motion in motions:
        columns += _angle(name, motion) if name else _length(unit, motion)
    return columns + _in_time(drive, motions, unit)


def _once(compute: Callable[[FloatArray, Side], Value]) -> Callable[[FloatArray, Side], Value]:
    """The same, computed once for the columns that share it: they are called one after another."""
    kept: list[tuple[FloatArray, Side, Value]] = []

    def values(phi: FloatArray, side: Side) -> Value:
        if not kept or kept[0][0] is not phi or kept[0][1] != side:
            kept[:] = [(phi, side, compute(phi, side))]
        return kept[0][2]

    return values


def quantities_of_disc(disc: Disc, unit: LengthUnit) -> Columns:
    """Curves, transmission angle and curvature.

    A flat face has one curve, the outline on which its contact runs, and the position of the
    contact on the face.
    """
    mm = MM_PER[unit]

    def pitch() -> PitchCurve:
        return disc.pitch_curve

    points: dict[str, Callable[[FloatArray, Side], ComplexArray]]
    points = {"contact": lambda phi, side: pitch().point(phi, side)}
    if disc.follower.has_pitch_curve:
        points = {
            "pitch": lambda phi, side: pitch().point(phi, side),
            "inner": lambda phi, side: disc.inner_curve.point(phi, side),
            "outer": lambda phi, side: disc.outer_curve.point(phi, side),
        }
    columns: Columns = []
    for name, compute in points.items():
        point = _once(compute)
        columns.append((f"{name} x [{unit}]", _coordinate(point, np.real, mm)))
        columns.append((f"{name} y [{unit}]", _coordinate(point, np.imag, mm)))
    if not disc.follower.has_pitch_curve:

        def on_face(phi: FloatArray, side: Side) -> FloatArray:
            found: FloatArray = touch(pitch(), phi, side).contact[0] / mm
            return found

        columns.append((f"on face [{unit}]", on_face))
    kappa = _once(lambda phi, side: pitch().curvature(phi, side))
    return [
        *columns,
        ("mu [deg]", lambda phi, side: np.degrees(pitch().transmission_angle(phi, side))),
        (f"kappa [1/{unit}]", lambda phi, side: kappa(phi, side) * mm),
        (f"r_K [{unit}]", lambda phi, side: radius_of_curvature(kappa(phi, side)) / mm),
    ]


def _motions(drive: Drive, lift_unit: LiftUnit) -> list[tuple[str, JetOfMotion]]:
    """The motion that the scene prescribes, and the follower's own if it differs.

    Each gives (4, n), with the name of its angle, empty for a length.
    """
    own = _once(lambda phi, side: drive.motion.jet(phi, side))
    found: list[tuple[str, JetOfMotion]] = [("psi" if lift_unit == "rad" else "", own)]
    if drive.demanded_of != "follower":
        demanded = _once(lambda phi, side: drive.plan.jet(phi, side))
        found.insert(0, (ANGLES.get(drive.demanded_of, ""), demanded))
    return found


def _coordinate(
    point: Callable[[FloatArray, Side], ComplexArray],
    part: Callable[[ComplexArray], FloatArray],
    mm: float,
) -> Quantity:
    return lambda phi, side: part(point(phi, side)) / mm


def _timed(motion: JetOfMotion, course: TimeCourse) -> JetOfMotion:
    return lambda phi, side: in_time(motion(phi, side), course, phi)


def _row(motion: JetOfMotion, order: int, shown: Callable[[FloatArray], FloatArray]) -> Quantity:
    """One derivative of a motion, as it is shown."""
    return lambda phi, side: shown(motion(phi, side)[order])


def _length(unit: LengthUnit, motion: JetOfMotion) -> Columns:
    mm = MM_PER[unit]
    rates = ("", "/rad", "/rad^2", "/rad^3")
    return [
        (f"s{mark} [{unit}{rate}]", _row(motion, order, lambda values: values / mm))
        for order, (mark, rate) in enumerate(zip(MARKS, rates, strict=True))
    ]


def _angle(name: str, motion: JetOfMotion) -> Columns:
    rates = zip(MARKS[1:], ("1", "1/rad", "1/rad^2"), strict=True)
    return [
        (f"{name} [deg]", _row(motion, 0, np.degrees)),
        *(
            (f"{name}{mark} [{rate}]", _row(motion, order, lambda values: values))
            for order, (mark, rate) in enumerate(rates, 1)
        ),
    ]


def _in_time(drive: Drive, motions: list[tuple[str, JetOfMotion]], unit: LengthUnit) -> Columns:
    """Time and derivatives in time: of the motion the scene prescribes, and of the follower."""
    course, mm = drive.time_course, MM_PER[unit]
    if course is None:
        return []
    columns: Columns = [("t [s]", lambda phi, _: course.time(phi))]
    for name, motion in motions:
        timed = _once(_timed(motion, course))
        for order, power in enumerate(POWERS, 1):
            if name:
                heading = f"{SWING[order - 1]}_{name} [deg/{power}]"
                columns.append((heading, _row(timed, order, np.degrees)))
            else:
                heading = f"{TIMED[order - 1]} [{unit}/{power}]"
                columns.append((heading, _row(timed, order, lambda values: values / mm)))
    return columns


def of_effect(unit: LengthUnit, column: Column) -> tuple[str, Quantity]:
    """Heading and values of an effect's column, lengths in `unit`."""
    own, divisor = unit_in(column.unit, unit)

    def divided(phi: FloatArray, side: Side) -> FloatArray:
        return column.values(phi, side) / divisor

    values = column.values if divisor == 1.0 else divided
    return f"{column.name} [{own}]" if own else column.name, values
