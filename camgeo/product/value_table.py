"""The value table of a design: motion, curves, transmission angle and curvature over a turn."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import TYPE_CHECKING

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.cam.drive import Demanded, Drive
from camgeo.curve.extremes import radius_of_curvature
from camgeo.formats.csv import FORMAT, exact_step
from camgeo.lazy import Ledger, lazy
from camgeo.motion.motion import Jet
from camgeo.motion.time_course import in_time
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.outline.convex import touch
from camgeo.pickled import Pickled
from camgeo.units import MM_PER, LengthUnit, LiftUnit

if TYPE_CHECKING:  # few scenes name an effect
    from camgeo.effects.effect import Column
    from camgeo.scene.scene import Scene

FULL_TURN = Decimal(360)

POWERS = ("s", "s^2", "s^3")

MARKS = ("", "'", "''", "'''")
"""Units of a motion's derivatives over the cam angle."""

ANGLES: dict[Demanded, str] = {"lever": "chi", "crank": "theta"}
"""Name of a prescribed angle that is not the follower's own."""

Columns = list[tuple[str, FloatArray]]
"""Headings, each with its values (n,)."""

SWING = ("omega", "alpha", "j")
"""Prefixes of the names of angular velocity, acceleration and jerk."""


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Named columns of equal length.

    Attributes
    ----------
    names : of the columns, with their unit in brackets, e.g. "phi [deg]".
    values : (n, k), one column per name, without NaN.
    cells : the same as text, for rounded numbers; None for the shortest form that reads back the
        same, in which no number is -0.0.
    """

    names: tuple[str, ...]
    values: FloatArray
    cells: Sequence[Sequence[str]] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))

    @classmethod
    def rounded(cls, names: tuple[str, ...], cells: Sequence[Sequence[str]]) -> Table:
        """A table of rounded numbers."""
        return cls(names, np.array(cells, dtype=np.float64), cells)

    @property
    def columns(self) -> dict[str, FloatArray]:
        """The columns by name, (n,) each."""
        return dict(zip(self.names, self.values.T, strict=True))

    def csv(self) -> str:
        """The table as CSV, below one header line."""
        stream = io.StringIO()
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(self.names)
        shortest = ([repr(value) for value in (row + 0.0).tolist()] for row in self.values)
        rows.writerows(self.cells or shortest)
        return stream.getvalue()


def cam_angles(step: Decimal) -> FloatArray:
    """0, step, 2 step, ... below 360 [degrees], each rounded once from the exact decimal.

    Adding up floats would reach 359.999999999988 after 1,800 steps of 0.2 and give one row too
    many.
    """
    count = math.ceil(FULL_TURN / step)
    return np.array([float(step * k) for k in range(count)])


@dataclass(frozen=True)
class TabulatedCam(Pickled):
    """A cam as value tables list it.

    Attributes
    ----------
    drive : what moves the follower.
    scene : has the unit of lengths in the table, and its step.
    cam : the cam; None if there is no follower.
    columns : gives the effects over the cam angle.
    ledger : records what was computed.
    """

    drive: Drive
    scene: Scene
    cam: Cam | None
    columns: Callable[[], tuple[Column, ...]]
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def table(self, step: Decimal | float | None = None) -> Table:
        """One row for every `step` degrees of cam angle, by default the scene's step; right-hand
        values at the joints. A float counts as the decimal number that Python prints for it.

        With a speed also the time and the derivatives in time: velocity, acceleration and jerk;
        then the cam's columns, if there is a cam, and the effects. In the scene's unit and degrees.
        """
        if step is None:
            return self.value_table
        degrees = cam_angles(exact_step(step))
        return self.ledger.run("value_table", lambda: self._table(degrees))

    @lazy
    def value_table(self) -> Table:
        """The table at the scene's step."""
        return self._table(cam_angles(self.scene.output.options[FORMAT].step))

    def _table(self, degrees: FloatArray) -> Table:
        phi, unit = np.radians(degrees), self.scene.unit
        columns: Columns = [("phi [deg]", degrees)]
        motions = _motions(self.drive, self.scene.lift_unit, phi)
        for name, motion in motions:
            columns += _angle(name, motion) if name else _length(unit, motion)
        columns += _in_time(self.drive, motions, unit, phi)
        if self.cam is not None:
            columns += _of_cam(self.cam, unit, phi)
        columns += [_of_effect(unit, column, phi) for column in self.columns()]
        names = tuple(name for name, _ in columns)
        return Table(names, np.column_stack([values for _, values in columns]))


def _of_cam(cam: Cam, unit: LengthUnit, phi: FloatArray) -> Columns:
    """Curves, transmission angle and curvature.

    A flat face has one curve, the outline on which its contact runs, and the position of the
    contact on the face.
    """
    disc, mm = cam.disc, MM_PER[unit]
    pitch = disc.pitch_curve
    columns: Columns = []
    curves = [("contact", pitch.point(phi))]
    if cam.follower.has_pitch_curve:
        curves = [
            ("pitch", pitch.point(phi)),
            ("inner", disc.inner_curve.point(phi)),
            ("outer", disc.outer_curve.point(phi)),
        ]
    for name, points in curves:
        columns.append((f"{name} x [{unit}]", points.real / mm))
        columns.append((f"{name} y [{unit}]", points.imag / mm))
    if not cam.follower.has_pitch_curve:
        columns.append((f"on face [{unit}]", touch(pitch, phi, "right").contact[0] / mm))
    kappa = pitch.curvature(phi)
    columns.append(("mu [deg]", np.degrees(pitch.transmission_angle(phi))))
    columns.append((f"kappa [1/{unit}]", kappa * mm))
    columns.append((f"r_K [{unit}]", radius_of_curvature(kappa) / mm))
    return columns


def _motions(drive: Drive, lift_unit: LiftUnit, phi: FloatArray) -> list[tuple[str, Jet]]:
    """The motion that the scene prescribes, and the follower's own if it differs.

    Each (4, n) with the name of its angle, empty for a length.
    """
    found = [("psi" if lift_unit == "rad" else "", drive.motion.jet(phi))]
    if drive.demanded_of != "follower":
        found.insert(0, (ANGLES.get(drive.demanded_of, ""), drive.plan.jet(phi)))
    return found


def _length(unit: LengthUnit, motion: Jet) -> list[tuple[str, FloatArray]]:
    return [
        (f"s{mark} [{unit}{rate}]", values / MM_PER[unit])
        for mark, rate, values in zip(MARKS, ("", "/rad", "/rad^2", "/rad^3"), motion, strict=True)
    ]


def _angle(name: str, motion: Jet) -> list[tuple[str, FloatArray]]:
    rates = zip(MARKS[1:], ("1", "1/rad", "1/rad^2"), motion[1:], strict=True)
    return [
        (f"{name} [deg]", np.degrees(motion[0])),
        *((f"{name}{mark} [{rate}]", values) for mark, rate, values in rates),
    ]


def _in_time(
    drive: Drive, motions: list[tuple[str, Jet]], unit: LengthUnit, phi: FloatArray
) -> Columns:
    """Time and derivatives in time: of the motion the scene prescribes, and of the follower."""
    course = drive.time_course
    if course is None:
        return []
    columns = [("t [s]", course.time(phi))]
    for name, motion in motions:
        timed = in_time(motion, course, phi)[1:]
        if name:
            for kind, power, values in zip(SWING, POWERS, timed, strict=True):
                columns.append((f"{kind}_{name} [deg/{power}]", np.degrees(values)))
            continue
        for kind, power, values in zip(("v", "a", "j"), POWERS, timed, strict=True):
            columns.append((f"{kind} [{unit}/{power}]", values / MM_PER[unit]))
    return columns


def _of_effect(unit: LengthUnit, column: Column, phi: FloatArray) -> tuple[str, FloatArray]:
    """Heading and values of an effect's column, lengths in `unit`."""
    own, values = column.unit, column.values(phi, "right")
    if own == "mm" or own.startswith("mm/"):
        own, values = unit + own.removeprefix("mm"), values / MM_PER[unit]
    return f"{column.name} [{own}]" if own else column.name, values
