"""Answer of `camgeo slotted-lever`: the motion of a slotted lever at constant crank speed."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from camgeo.app.answers import answer
from camgeo.app.answers.answer import FINE, Answer, Key
from camgeo.app.cli.command import (
    Argument,
    ArgumentGroup,
    CallError,
    decimal,
    output_files,
    picture_options,
    require_same_folder,
    show,
    table_file,
    write,
    write_files,
)
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, LeverExtreme, SlottedLever
from camgeo.numeric.arrays import FloatArray
from camgeo.units import RPM

if TYPE_CHECKING:
    from camgeo.design.value_table import Table
    from camgeo.pictures.model import Figure


LOWEST, HIGHEST = 1e-100, 1e100
"""Limits of lengths [mm] and speeds [rev/min]: results computed from them cannot overflow."""

Number = float | Decimal

Rows = tuple[Decimal, Decimal, Decimal]
"""Step, first and last crank angle of a table [deg]."""

DEGREES: Final = Decimal(360)
"""Crank angle of a full turn [deg]."""

FULL_TURN: Final[Rows] = (Decimal(1), Decimal(0), DEGREES)
"""The rows of the table in the SAM exercise."""


@dataclass(frozen=True, slots=True)
class LeverMotion(Answer):
    """The lever and its motion.

    Attributes
    ----------
    driven : the lever with the speed of its crank, and thus its extremes and strokes.
    table : values over the crank angle, in degrees; None if it was not requested.
    """

    driven: DrivenLever
    table: Table | None = None

    @property
    def swing(self) -> float | None:
        """Angle between the end positions [rad]; None for a lever that makes full turns."""
        lever = self.driven.lever
        return 2.0 * lever.largest_angle.value if lever.swings else None

    @property
    def time_ratio(self) -> float | None:
        """Duration of the slow stroke divided by that of the quick one; None without strokes."""
        lever = self.driven.lever
        return lever.time_ratio if lever.swings else None


def slotted_lever(
    frame: Number,
    speed: Number,
    *,
    crank: Number | None = None,
    swing: Number | None = None,
    rows: Rows | None = None,
    printed: bool = False,
) -> LeverMotion:
    """Compute the motion of a slotted lever.

    Parameters
    ----------
    frame : distance of the axes of crank and lever [mm].
    speed : of the crank [rev/min].
    crank, swing : radius of the crank [mm], or whole swing of the lever [deg]; exactly one of them.
    rows : of the table, `FULL_TURN` for that of the exercise; None for no table.
    printed : whether the table is rounded to three decimals, as the exercise prints it.

    Raises
    ------
    GeometryError
        With the name of the parameter as its key, of `rows` "step", "from" or "to".
    """
    distance = _checked("frame", frame, "mm")
    if swing is not None:
        radius = SlottedLever.crank_for_swing(distance, float(swing))
        if radius < LOWEST:
            message = f"makes a crank of {radius:g} mm; at least {LOWEST:g} mm is allowed"
            raise GeometryError(message, key="swing", value=str(swing))
    elif crank is not None:
        radius = _checked("crank", crank, "mm")
    else:
        raise GeometryError("is missing: either the crank or the swing is needed", key="crank")
    driven = DrivenLever(SlottedLever(radius, distance), _checked("speed", speed, "rev/min") * RPM)
    return LeverMotion(driven, None if rows is None else _table(driven, rows, printed))


def _checked(key: str, stated: Number, unit: str) -> float:
    value = float(stated)
    if not LOWEST <= value <= HIGHEST:
        message = f"must be from {LOWEST:g} to {HIGHEST:g} {unit}"
        raise GeometryError(message, key=key, value=str(stated))
    return value


def _table(driven: DrivenLever, rows: Rows, printed: bool) -> Table:
    from camgeo.design.value_table import Table

    exact = lever_table(driven, *rows)
    return Table.rounded(NAMES, exact.printed()) if printed else Table(NAMES, exact.values)


# -- table ---------------------------------------------------------------------------------------
# The table of the motion over the crank angle, as the SAM exercise prints it.


NAMES: Final = ("crank [deg]", "time [s]", "phi [deg]", "omega2 [rad/s]", "eps2 [rad/s^2]")
"""Columns in the order of the exercise's table."""

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(90)

PRINTED_DECIMALS: Final = 3
"""Decimals in all columns of that table except the crank angle."""

MOST_DECIMALS: Final = 12
"""Most decimals of a step and of the ends of a table."""


@dataclass(frozen=True, slots=True, eq=False)
class LeverTable:
    """Values of a slotted lever at equidistant crank angles.

    Attributes
    ----------
    crank : (n,) crank angles [deg], exact.
    values : (n, 5), the columns `NAMES`; angles are positive as the crank turns, time
        starts at the crank angle 0. Finite, no -0.0.
    """

    crank: tuple[Decimal, ...]
    values: FloatArray

    def printed(self) -> list[tuple[str, ...]]:
        """The rows rounded as in the exercise, to three decimals.

        A number is rounded from all its digits; what rounds to zero has no sign. The crank angle is
        exact, with as many decimals as the rows need.
        """
        places = max(_places(angle) for angle in self.crank)
        return [
            (f"{angle:.{places}f}", *(f"{value:z.{PRINTED_DECIMALS}f}" for value in row[1:]))
            for angle, row in zip(self.crank, self.values.tolist(), strict=True)
        ]


def lever_table(
    driven: DrivenLever,
    step: Decimal = FULL_TURN[0],
    first: Decimal = FULL_TURN[1],
    last: Decimal = DEGREES,
) -> LeverTable:
    """Tabulate a slotted lever at first, first + step, ... below last, and at last.

    The multiples are exact, so rounding neither drops nor duplicates a row; a step that does not
    divide the range makes the last interval shorter. Beyond 180 degrees the values are those at 360
    degrees minus the angle with the signs of the symmetry, so that both halves agree to the last
    digit and phi and eps_2 are 0 at 180 degrees.

    Parameters
    ----------
    driven : the slotted lever and its speed.
    step : of the crank angle [deg], from 0.001 to 90.
    first, last : crank angles [deg], 0 <= first < last <= 360.
        All three with at most twelve decimals.

    Raises
    ------
    GeometryError
        With key "step", "from" or "to" outside these limits; with key "from" or "to", if the crank
        is as long as the distance between the axes and the range includes 0 or 360, where phi is
        undefined.
    """
    _check(step, first, last)
    with localcontext() as context:
        # Three digits before the point and `MOST_DECIMALS` after it: every sum is exact.
        context.prec = max(context.prec, 28)
        count = math.ceil(Fraction(last - first) / Fraction(step))
        crank = (*(first + step * number for number in range(count)), last)
        # phi and eps_2 are odd about 180 degrees, omega_2 is even: the first half suffices.
        folded = [min(angle, DEGREES - angle) for angle in crank]
    half = DEGREES / 2
    side = np.array([float((angle < half) - (angle > half)) for angle in crank])
    lever = driven.lever
    if lever.crank == lever.distance:
        for key, end in (("from", first), ("to", last)):
            if end % DEGREES == 0:
                raise GeometryError(
                    "the crank is as long as the distance between the axes: at 0 and 360 degrees"
                    " its pin is on the axis of the lever, whose angle is undefined there; angles"
                    " between the two are allowed",
                    key=key,
                    value=str(end),
                )
    phi, omega, eps = driven.output(np.radians([float(angle) for angle in folded]))
    degrees = np.array([float(angle) for angle in crank])
    columns = (degrees, degrees / 360.0 * driven.turn_time, side * np.degrees(phi), omega)
    return LeverTable(crank, np.column_stack((*columns, side * eps)) + 0.0)


def _check(step: Decimal, first: Decimal, last: Decimal) -> None:
    for key, number in (("step", step), ("from", first), ("to", last)):
        if number.is_finite() and _places(number) > MOST_DECIMALS:
            raise GeometryError(
                f"at most {MOST_DECIMALS} decimals are allowed", key=key, value=str(number)
            )
    if not (step.is_finite() and SMALLEST_STEP <= step <= LARGEST_STEP):
        message = f"the step of the crank angle must be {SMALLEST_STEP} to {LARGEST_STEP} degrees"
        raise GeometryError(message, key="step", value=str(step))
    if not (first.is_finite() and 0 <= first < DEGREES):
        message = "the first crank angle must be from 0 to less than 360 degrees"
        raise GeometryError(message, key="from", value=str(first))
    if not (last.is_finite() and first < last <= DEGREES):
        message = f"the last crank angle must be above the first, {first}, and at most 360 degrees"
        raise GeometryError(message, key="to", value=str(last))


def _places(number: Decimal) -> int:
    """Decimals of a finite number, without trailing zeros."""
    exponent = number.normalize().as_tuple().exponent
    assert isinstance(exponent, int)  # a letter if it is not finite
    return max(0, -exponent)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "The motion of a slotted lever whose crank turns at constant speed. Angles are positive in"
    " the crank's sense of rotation; the crank angle counts from where its pin is nearest the"
    " lever's axis, phi from where the lever points to the crank's axis.",
    {
        "frame_mm": Key(
            "Distance between the axes of crank and lever.", of="driven.lever.distance"
        ),
        "crank_mm": Key("Radius of the crank.", of="driven.lever.crank"),
        "ratio": Key("Ratio of frame to crank.", of="driven.lever.ratio"),
        "swings": Key(
            "Whether the lever oscillates; otherwise it rotates.", of="driven.lever.swings"
        ),
        "swing_deg": "Swing from one end to the other; null for a lever that rotates.",
        "speed_rad_per_s": Key("Speed of the crank.", of="driven.speed"),
        "turn_s": Key("Duration of one turn of the crank.", of="driven.turn_time"),
        "extremes": Key(
            "Largest and smallest values over one turn of the crank: phi, omega2, eps2, each by"
            " ascending crank angle. No phi for a lever that rotates; none at all for a crank as"
            " long as the frame.",
            {
                "quantity": (
                    "phi, the angle of the lever, omega2, its velocity, or eps2, its acceleration."
                ),
                "largest": "True for the largest value with its sign, false for the smallest.",
                "value": "Value of the quantity, in `unit`.",
                "unit": Key("Unit of the value.", type=Literal["rad", "rad/s", "rad/s^2"]),
                "crank_deg": "Crank angle.",
                "time_s": "Time since crank angle 0.",
                "phi_deg": Key("Angle of the lever there.", of="angle"),
            },
            of="driven.extremes",
        ),
        "strokes": Key(
            "The slow stroke and the quick one; null for a lever that rotates.",
            {
                "crank_from_deg": Key("Crank angle at its start.", of="start"),
                "crank_to_deg": Key("Crank angle at its end; may exceed a turn.", of="end"),
                "duration_s": "Duration of the stroke.",
            },
            of="driven.strokes",
        ),
        "time_ratio": (
            "Duration of the slow stroke over that of the quick one; null without strokes."
        ),
        "table": Key(
            "The columns of the value table, with --table or --csv; names have the unit in"
            " brackets.",
            of="table.columns",
            optional=True,
        ),
    },
    type=LeverMotion,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo slotted-lever` in words, as a table and as a diagram.


NOTES = """\
angles are positive in the crank's sense of rotation: the crank's from where its pin is nearest the
lever's axis, phi from where the lever points to the crank's axis
--table prints the values over the crank angle, --table --printed to three decimals""".splitlines()

NAME, NUMBER, WIDE = 18, 14, 20
"""Widths of the columns."""


def text(answer: LeverMotion) -> str:
    """Sizes, extremes and strokes; seven digits of a number."""
    driven, lever = answer.driven, answer.driven.lever
    frame, crank, ratio = _text(lever.distance), _text(lever.crank), _text(lever.ratio)
    rpm, speed, turn = _text(driven.speed / RPM), _text(driven.speed), _text(driven.turn_time)
    lines = [
        f"slotted lever: frame a = {frame} mm, crank R = {crank} mm, a/R = {ratio}",
        f"crank: {rpm} rev/min, omega0 = {speed} rad/s, one turn in {turn} s",
        f"lever: {_kind(answer)}",
        "",
    ]
    if driven.extremes:
        lines.append(
            f"{'extreme':{NAME}}{'value':>{NUMBER}}{'':9}{'in degrees':>{WIDE}}"
            f"{'crank [deg]':>{NUMBER}}{'time [s]':>{NUMBER}}{'phi [deg]':>{NUMBER}}"
        )
        lines += [_row(extreme) for extreme in driven.extremes]
    else:
        lines.append(f"omega2 is {_text(0.5 * driven.speed)} rad/s everywhere, and eps2 is 0")
        lines.append("at crank angle 0 the pin lies on the lever's axis: phi is undefined there")
    lines.append("")
    if driven.strokes is None or answer.time_ratio is None:
        lines.append("strokes: none, and no time ratio, because the lever does not swing")
    else:
        lines += [
            f"{name:{NAME}}crank {_degrees(stroke.start)} to {_degrees(stroke.end)} deg,"
            f" {_degrees(stroke.end - stroke.start)} deg in {_text(stroke.duration)} s"
            for name, stroke in zip(("slow stroke", "quick stroke"), driven.strokes, strict=True)
        ]
        lines.append(f"{'time ratio':{NAME}}{_text(answer.time_ratio)}")
    return "\n".join([*lines, "", *NOTES])


def table(answer: LeverMotion) -> Table:
    """The requested values over the crank angle."""
    assert answer.table is not None  # rendered only if it was requested
    return answer.table


def figure(answer: LeverMotion) -> Figure:
    """Angle, velocity and acceleration over the crank angle."""
    from camgeo.pictures import slotted_lever

    return slotted_lever.figure(answer.driven)


def _kind(answer: LeverMotion) -> str:
    lever = answer.driven.lever
    if answer.swing is not None:
        return f"swings, by {_degrees(answer.swing)} deg in all"
    if lever.crank == lever.distance:
        return "turns half a turn with each turn of the crank, because R = a"
    return "turns round with the crank, because R > a, and never stands still"


def _row(extreme: LeverExtreme) -> str:
    size = "largest" if extreme.largest else "smallest"
    in_degrees = f"{_degrees(extreme.value)} {extreme.unit.replace('rad', 'deg')}"
    return (
        f"{f'{size} {extreme.quantity}':{NAME}}{_text(extreme.value):>{NUMBER}} {extreme.unit:8}"
        f"{in_degrees:>{WIDE}}{_degrees(extreme.crank):>{NUMBER}}{_text(extreme.time):>{NUMBER}}"
        f"{_degrees(extreme.angle):>{NUMBER}}"
    )


def _text(value: float) -> str:
    return f"{value + 0.0:.7g}"


def _degrees(angle: float) -> str:
    return _text(math.degrees(angle))


# -- command line ----------------------------------------------------------------------------------


TABLE_OPTIONS: Final = dict(zip(("step", "from", "to"), FULL_TURN, strict=True))
"""Options of the rows of a table, with their defaults."""


EXAMPLE: Final = (
    "camgeo slotted-lever --frame 150 --swing 60 --speed 90 -o slotted-lever.png\n"
    "  camgeo slotted-lever --frame 150 --swing 60 --speed 90 --table --printed\n"
    "  camgeo slotted-lever --frame 50 --crank 80 --speed 90 --csv turning.csv --step 0.5"
)


ARGUMENTS: Final = (
    Argument(
        "--frame",
        metavar="MM",
        type=decimal,
        required=True,
        help="a, distance between the axes of crank and lever",
    ),
    ArgumentGroup(
        Argument(
            "--swing",
            metavar="DEG",
            type=decimal,
            help="whole swing of the lever; the crank is a sin(swing/2)",
        ),
        Argument(
            "--crank",
            metavar="MM",
            type=decimal,
            help="R, radius of the crank; with R > a the lever makes full turns",
        ),
        required=True,
    ),
    Argument(
        "--speed", metavar="RPM", type=decimal, required=True, help="speed of the crank in rev/min"
    ),
    ArgumentGroup(
        Argument("--table", action="store_true", help="print the value table as CSV instead"),
        Argument("--csv", metavar="FILE", help="write the value table to a file"),
        Argument("--step", metavar="DEG", type=decimal, help="step of the crank angle, default 1"),
        Argument("--from", metavar="DEG", type=decimal, help="first crank angle, default 0"),
        Argument("--to", metavar="DEG", type=decimal, help="last crank angle, default 360"),
        Argument(
            "--printed",
            action="store_true",
            help="to three decimals, as the SAM exercise prints it",
        ),
        title="value table",
    ),
    *picture_options(),
)


def run(arguments: argparse.Namespace) -> int:
    """Print extremes or table; write table and picture, both or none."""
    tabled = arguments.table or arguments.csv is not None
    stated = {key: getattr(arguments, key) for key in TABLE_OPTIONS}
    known = {key: value for key, value in stated.items() if value is not None}
    if not tabled and (known or arguments.printed):
        names = [f"--{name}" for name in known] + ["--printed"] * arguments.printed
        raise CallError(f"{', '.join(names)}: allowed with --table or --csv only")
    require_same_folder("--csv", arguments.csv, arguments.output)
    step, first, last = (TABLE_OPTIONS | known).values()
    motion = slotted_lever(
        arguments.frame,
        arguments.speed,
        crank=arguments.crank,
        swing=arguments.swing,
        rows=(step, first, last) if tabled else None,
        printed=arguments.printed,
    )
    files = output_files(motion, arguments, "phi, omega2, eps2")
    if arguments.csv is not None:
        files = [table_file(answer.table(motion), Path(arguments.csv)), *files]
    write_files(files, arguments)
    if arguments.table and not arguments.json:
        write(answer.table(motion).csv())
        return FINE
    return show(motion, arguments)
