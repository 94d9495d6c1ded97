"""The value table of a design: motion, curves, transmission angle and curvature over a turn."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from camgeo.cam.cam import Cam, Demanded, Disc, Drive
from camgeo.errors import GeometryError, meant
from camgeo.geometry.pieces import touch
from camgeo.kinematics.motion import Jet
from camgeo.kinematics.time_course import in_time
from camgeo.lazy import Ledger, lazy
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, frozen
from camgeo.record import Displayed, Pickled
from camgeo.scene.formats.csv import FORMAT, CsvSpec, exact_step
from camgeo.units import MM_PER, LengthUnit, LiftUnit, counted, unit_and_divisor

if TYPE_CHECKING:
    from camgeo.dynamics.effects.effect import Column
    from camgeo.geometry.pitch_curve import PitchCurve
    from camgeo.kinematics.time_course import TimeCourse
    from camgeo.scene.scene import Scene


FULL_TURN = Decimal(360)

NUMBERS: Final = 5_000_000
"""Most numbers of a table: 40 MB, as text twice as much, and both exist several times."""

CAM_ANGLE: Final = "phi [deg]"

CURVES = ("pitch", "inner", "outer", "contact")
"""Names of curves in the headings of their coordinates."""


@dataclass(frozen=True, slots=True, eq=False)
class Table(Displayed):
    """Named columns of equal length.

    Attributes
    ----------
    names : names of the columns, with their unit in brackets, e.g. "phi [deg]".
    values : (n, k), one column per name, without NaN.
    cells : the numbers as text, if they have been rounded one by one; None to use `decimals`.
    decimals : decimals to which all numbers are rounded; None for the shortest form that reads back
        the same, in which no number is -0.0.
    separator : separator between columns in the text.
    decimal_comma : whether numbers in the text have a decimal comma.
    """

    names: tuple[str, ...]
    values: FloatArray
    cells: Sequence[Sequence[str]] | None = None
    decimals: int | None = None
    separator: str = ","
    decimal_comma: bool = False

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
        return self.encoded().decode()

    def encoded(self) -> bytes:
        """The table as CSV in UTF-8, which takes no more memory than twice its size."""
        buffer = io.BytesIO()
        stream = io.TextIOWrapper(buffer, "utf-8", newline="")
        rows = csv.writer(stream, delimiter=self.separator, lineterminator="\n")
        rows.writerow(self.names)
        spelled = repr if self.decimals is None else f"{{:.{self.decimals}f}}".format
        # Adding 0.0 turns -0.0 into 0.0.
        numbers = ([spelled(value) for value in (row + 0.0).tolist()] for row in self.values)
        cells: Iterable[Sequence[str]] = self.cells or numbers
        if self.decimal_comma:
            cells = ([cell.replace(".", ",") for cell in row] for row in cells)
        rows.writerows(cells)
        stream.flush()
        return buffer.getvalue()


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
    drive : drive of the follower: motion plan, linkage and speed.
    scene : the scene, with the unit of lengths in the table, and the step.
    cam : the cam; None if there is no follower.
    columns : returns the effects over the cam angle.
    ledger : records what was computed.
    """

    drive: Drive
    scene: Scene
    cam: Cam | None
    columns: Callable[[], tuple[Column, ...]]
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def table(self, step: Decimal | float | None = None) -> Table:
        """The table with a row for every `step` degrees of cam angle, by default the scene's step.

        A float counts as the decimal number that Python prints for it. Joints have their right-hand
        values. If there is a speed, the motion is followed by the time and by velocity,
        acceleration and jerk; then come the columns of the cam, if there is one, and the effects.
        Lengths are in the scene's unit, angles in degrees.
        """
        if step is None:
            return self.value_table
        degrees = cam_angles(exact_step("output.csv.step", step))
        with self.ledger.entry("value_table"):
            return self._table(degrees)

    @lazy
    def value_table(self) -> Table:
        """The table at the scene's step."""
        return self._table(cam_angles(self.scene.output.options[FORMAT].step))

    def stated(self, step: Decimal | float | None = None) -> Table:
        """The table as [output.csv] states it, its numbers not rounded; steps as for `table`."""
        spec = self.scene.output.options[FORMAT]
        unit = spec.unit or self.scene.unit
        if unit == self.scene.unit:
            whole = self.table(step)
        else:
            whole = self._table(
                cam_angles(spec.step if step is None else exact_step("output.csv.step", step)), unit
            )
        return stated_table(whole, spec, unit)

    def written(self, step: Decimal | float | None = None) -> Table:
        """The table as [output.csv] states it, its numbers rounded; steps as for `table`."""
        return rounded(self.stated(step), self.scene.output.options[FORMAT].decimals)

    def _table(self, degrees: FloatArray, unit: LengthUnit | None = None) -> Table:
        unit = unit or self.scene.unit
        columns = quantities(self.drive, self.scene.lift_unit, self.cam, unit)
        columns += [effect_column(unit, column) for column in self.columns()]
        _require_few(len(degrees), len(columns) + 1)
        phi = np.radians(degrees)
        values = [degrees, *(quantity(phi, "right") for _, quantity in columns)]
        names = (CAM_ANGLE, *(name for name, _ in columns))
        return Table(names, np.column_stack(values))


def _require_few(rows: int, columns: int) -> None:
    """GeometryError with the key of the step, if a table would have more than `NUMBERS` numbers."""
    if rows * columns > NUMBERS:
        size = f"{counted(rows, 'row')} of {counted(columns, 'column')}"
        message = f"{size} are more than {counted(NUMBERS, 'number')}"
        raise GeometryError(message, "output.csv.step")


def stated_table(whole: Table, spec: CsvSpec, unit: LengthUnit) -> Table:
    """The columns of `whole` that a scene states, or all of them; its lengths are in `unit`.

    Raises GeometryError with the key of a column that does not exist.
    """
    # Without any option besides the step the table is as it is.
    if spec == CsvSpec(spec.step):
        return whole
    columns = whole.columns
    if spec.columns is not None:
        named = {bare(heading): heading for heading in columns}
        known = columns | _polar(columns, unit)
        named |= {bare(heading): heading for heading in known}
        for place, name in enumerate(spec.columns, 1):
            if name not in named:
                hint = meant(name, named)
                message = (
                    f"is not a column{f', {hint}' if hint else ''}; the columns are"
                    f" {', '.join(named)}"
                )
                raise GeometryError(message, f"output.csv.columns[{place}]", f'"{name}"')
        columns = {named[name]: known[named[name]] for name in spec.columns}
    if spec.angle == "rad":
        columns = dict(_radians_column(heading, values) for heading, values in columns.items())
    return Table(
        tuple(columns),
        np.column_stack(tuple(columns.values())),
        separator=spec.delimiter,
        decimal_comma=spec.decimal_comma,
    )


def rounded(table: Table, decimals: int | None) -> Table:
    """The table with its numbers rounded to so many `decimals`; None leaves them as they are."""
    if decimals is None:
        return table
    values = table.values.ravel()
    # Python rounds the exact value; NumPy scales it first, and may round the other way.
    near = np.fromiter((round(float(value), decimals) for value in values), np.float64, len(values))
    return replace(table, values=near.reshape(table.values.shape), decimals=decimals)


def bare(heading: str) -> str:
    """The name of a column without its unit."""
    return heading.rpartition(" [")[0] or heading


def _polar(columns: Mapping[str, FloatArray], unit: LengthUnit) -> dict[str, FloatArray]:
    """Radius and angle [degrees, 0 to 360] of the points of each curve, by column heading."""
    polar: dict[str, FloatArray] = {}
    for name in CURVES:
        x, y = (columns.get(f"{name} {axis} [{unit}]") for axis in "xy")
        if x is not None and y is not None:
            # The remainder of a tiny negative angle rounds to 360.
            turned = np.degrees(np.arctan2(y, x)) % 360.0
            polar[f"{name} radius [{unit}]"] = np.hypot(x, y)
            polar[f"{name} angle [deg]"] = np.where(turned < 360.0, turned, 0.0)
    return polar


def _radians_column(heading: str, values: FloatArray) -> tuple[str, FloatArray]:
    """Heading and values of a column with radians in place of degrees; others as they are."""
    name, separator, unit = heading.rpartition(" [")
    if not separator or not unit.startswith("deg"):
        return heading, values
    return f"{name} [rad{unit.removeprefix('deg')}", np.radians(values)


# -- quantities -----------------------------------------------------------------------------------
# The quantities over the cam angle that a value table has, each computed when it is called.


POWERS = ("s", "s^2", "s^3")
"""Divisors of the units of the first three derivatives with respect to time."""

MARKS = ("", "'", "''", "'''")
"""Marks of a motion and its derivatives with respect to the cam angle."""

ANGLES: dict[Demanded, str] = {"lever": "chi", "crank": "theta"}
"""Name of a prescribed angle that is not the follower's own."""

Quantity = Callable[[FloatArray, Side], FloatArray]
"""(n,) values at n cam angles [rad], approached from the given side."""

JetOfMotion = Callable[[FloatArray, Side], Jet]
"""(4, n) a motion and its three derivatives, likewise."""

Value = TypeVar("Value", FloatArray, ComplexArray)

Columns = list[tuple[str, Quantity]]
"""Headings, each with what gives its values."""

SWING = ("omega", "alpha", "j")
"""Prefixes of the names of angular velocity, acceleration and jerk."""

TIMED = ("v", "a", "j")
"""Names of velocity, acceleration and jerk."""


def quantities(drive: Drive, lift_unit: LiftUnit, cam: Cam | None, unit: LengthUnit) -> Columns:
    """The columns of a value table besides cam angle and effects, with lengths in `unit`.

    Right and left values differ where something jumps, which is only at breaks of the motion.
    """
    columns = quantities_of_drive(drive, lift_unit, unit)
    return columns if cam is None else columns + quantities_of_disc(cam.disc, unit)


def quantities_of_drive(drive: Drive, lift_unit: LiftUnit, unit: LengthUnit) -> Columns:
    """The columns of the motions over the cam angle and in time."""
    motions = _motions(drive, lift_unit)
    columns: Columns = []
    for name, motion in motions:
        columns += _angle(name, motion) if name else _length(unit, motion)
    return columns + _time_columns(drive, motions, unit)


def _once(compute: Callable[[FloatArray, Side], Value]) -> Callable[[FloatArray, Side], Value]:
    """`compute`, called once for all columns that share it, which ask one after another."""
    latest: list[tuple[FloatArray, Side, Value]] = []

    def values(phi: FloatArray, side: Side) -> Value:
        # Identity suffices, as all columns of a table get the same array.
        if not latest or latest[0][0] is not phi or latest[0][1] != side:
            latest[:] = [(phi, side, compute(phi, side))]
        return latest[0][2]

    return values


def quantities_of_disc(disc: Disc, unit: LengthUnit) -> Columns:
    """The columns of curves, transmission angle and curvature.

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
            places: FloatArray = touch(pitch(), phi, side).contact[0] / mm
            return places

        columns.append((f"on face [{unit}]", on_face))
    kappa = _once(lambda phi, side: pitch().curvature(phi, side))
    return [
        *columns,
        ("mu [deg]", lambda phi, side: np.degrees(pitch().transmission_angle(phi, side))),
        (f"kappa [1/{unit}]", lambda phi, side: kappa(phi, side) * mm),
        (f"r_K [{unit}]", lambda phi, side: radius_of_curvature(kappa(phi, side)) / mm),
    ]


def _motions(drive: Drive, lift_unit: LiftUnit) -> list[tuple[str, JetOfMotion]]:
    """The motion that the scene prescribes, and the follower's own motion if it differs.

    Each comes with the name of its angle, which is empty for a length.
    """
    follower_jet = _once(lambda phi, side: drive.motion.jet(phi, side))
    motions: list[tuple[str, JetOfMotion]] = [("psi" if lift_unit == "rad" else "", follower_jet)]
    if drive.demanded_member != "follower":
        demanded = _once(lambda phi, side: drive.plan.jet(phi, side))
        motions.insert(0, (ANGLES.get(drive.demanded_member, ""), demanded))
    return motions


def _coordinate(
    point: Callable[[FloatArray, Side], ComplexArray],
    part: Callable[[ComplexArray], FloatArray],
    mm: float,
) -> Quantity:
    return lambda phi, side: part(point(phi, side)) / mm


def _timed(motion: JetOfMotion, course: TimeCourse) -> JetOfMotion:
    return lambda phi, side: in_time(motion(phi, side), course, phi)


def _row(motion: JetOfMotion, order: int, convert: Callable[[FloatArray], FloatArray]) -> Quantity:
    """The derivative of a motion of that order, converted by `convert`."""
    return lambda phi, side: convert(motion(phi, side)[order])


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


def _time_columns(
    drive: Drive, motions: list[tuple[str, JetOfMotion]], unit: LengthUnit
) -> Columns:
    """The columns of time and of derivatives with respect to time, for each of the `motions`."""
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


def effect_column(unit: LengthUnit, column: Column) -> tuple[str, Quantity]:
    """Heading and values of an effect's column, with lengths in `unit`."""
    unit_text, divisor = unit_and_divisor(column.unit, unit)

    def divided(phi: FloatArray, side: Side) -> FloatArray:
        return column.values(phi, side) / divisor

    values = column.values if divisor == 1.0 else divided
    return f"{column.name} [{unit_text}]" if unit_text else column.name, values


def radius_of_curvature(kappa: FloatArray) -> FloatArray:
    """(n,) [mm] signed radius of the curvature `kappa` [1/mm]; infinite exactly at an inflection.

    Prefer the curvature, which has no poles.
    """
    radius: FloatArray = np.full_like(kappa, np.inf)
    return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)
