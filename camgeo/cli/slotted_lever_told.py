"""What `camgeo slotted-lever` tells of a slotted lever, as text and for JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from camgeo._version import __version__
from camgeo.mechanism.slotted_lever import SlottedLever
from camgeo.mechanism.slotted_lever_drive import (
    NAMES,
    DrivenLever,
    LeverExtreme,
    LeverTable,
    Quantity,
    Stroke,
)
from camgeo.units import RPM

QUANTITIES: Final[Mapping[Quantity, tuple[str, str]]] = {
    "angle": ("phi", "rad"),
    "velocity": ("omega2", "rad/s"),
    "acceleration": ("eps2", "rad/s^2"),
}
"""Symbol and unit of each quantity."""

NOTES: Final = """\
angles are counted as the crank turns: the crank's from where its pin is nearest the lever's axis,
phi from where the lever points to the crank's axis
--table prints the values over the crank angle, --table --printed to three decimals""".splitlines()

NAME, NUMBER, WIDE = 18, 14, 20
"""Widths of the columns."""

# Text ---------------------------------------------------------------------------------------------


def lines(driven: DrivenLever) -> list[str]:
    """What the command prints, a line each: sizes, extremes, strokes; seven digits of a number."""
    lever = driven.lever
    frame, crank, ratio = _text(lever.distance), _text(lever.crank), _text(lever.ratio)
    rpm, speed, turn = _text(driven.speed / RPM), _text(driven.speed), _text(driven.turn_time)
    found = [
        f"slotted lever: frame a = {frame} mm, crank R = {crank} mm, a/R = {ratio}",
        f"crank: {rpm} rev/min, omega0 = {speed} rad/s, one turn in {turn} s",
        f"lever: {_kind(lever)}",
        "",
    ]
    extremes = driven.extremes
    if extremes:
        found.append(
            f"{'extreme':{NAME}}{'value':>{NUMBER}}{'':9}{'in degrees':>{WIDE}}"
            f"{'crank [deg]':>{NUMBER}}{'time [s]':>{NUMBER}}{'phi [deg]':>{NUMBER}}"
        )
        found += [_row(extreme) for extreme in extremes]
        found.append("")
    else:
        found.append(f"omega2 is {_text(0.5 * driven.speed)} rad/s everywhere, and eps2 is 0")
        found.append(
            "at the crank angle 0 the pin lies in the lever's axis: phi is undefined there"
        )
        found.append("")
    strokes = driven.strokes
    if strokes is None:
        found.append("strokes: none, and no time ratio, for the lever does not swing")
    else:
        names = ("slow stroke", "quick stroke")
        found += [
            f"{name:{NAME}}crank {_degrees(stroke.start)} to {_degrees(stroke.end)} deg,"
            f" {_degrees(stroke.end - stroke.start)} deg in {_text(stroke.duration)} s"
            for name, stroke in zip(names, strokes, strict=True)
        ]
        found.append(f"{'time ratio':{NAME}}{_text(lever.time_ratio)}")
    return [*found, "", *NOTES]


def _kind(lever: SlottedLever) -> str:
    if lever.swings:
        return f"swings, by {_degrees(2.0 * lever.largest_angle.value)} deg in all"
    if lever.crank == lever.distance:
        return "turns by half a turn with each turn of the crank, for R = a"
    return "turns round with the crank, for R > a, and never stands still"


def _row(extreme: LeverExtreme) -> str:
    symbol, unit = QUANTITIES[extreme.quantity]
    size = "largest" if extreme.largest else "smallest"
    in_degrees = f"{_degrees(extreme.value)} {unit.replace('rad', 'deg')}"
    return (
        f"{f'{size} {symbol}':{NAME}}{_text(extreme.value):>{NUMBER}} {unit:8}{in_degrees:>{WIDE}}"
        f"{_degrees(extreme.crank):>{NUMBER}}{_text(extreme.time):>{NUMBER}}"
        f"{_degrees(extreme.angle):>{NUMBER}}"
    )


def _text(value: float) -> str:
    return f"{value + 0.0:.7g}"


def _degrees(angle: float) -> str:
    return _text(math.degrees(angle))


# JSON ---------------------------------------------------------------------------------------------


def document(driven: DrivenLever, table: LeverTable | None, *, printed: bool) -> dict[str, Any]:
    """The same for JSON, with all digits, and the columns of a table; angles in degrees.

    Values of phi, omega2 and eps2 among the extremes have the unit that stands beside them.
    """
    lever, strokes = driven.lever, driven.strokes
    swing = math.degrees(2.0 * lever.largest_angle.value) if lever.swings else None
    record: dict[str, Any] = {
        "camgeo": __version__,
        "frame_mm": lever.distance,
        "crank_mm": lever.crank,
        "ratio": lever.ratio,
        "swings": lever.swings,
        "swing_deg": swing,
        "speed_rad_per_s": driven.speed,
        "turn_s": driven.turn_time,
        "extremes": [_record(extreme) for extreme in driven.extremes],
        "strokes": None if strokes is None else [_stroke_record(stroke) for stroke in strokes],
        "time_ratio": lever.time_ratio if lever.swings else None,
    }
    if table is not None:
        rows = table.values.tolist()
        if printed:
            rows = [[float(cell) for cell in row] for row in table.printed()]
        columns = [list(column) for column in zip(*rows, strict=True)]
        record["table"] = dict(zip(NAMES, columns, strict=True))
    return record


def _record(extreme: LeverExtreme) -> dict[str, Any]:
    symbol, unit = QUANTITIES[extreme.quantity]
    return {
        "quantity": symbol,
        "largest": extreme.largest,
        "value": extreme.value,
        "unit": unit,
        "crank_deg": math.degrees(extreme.crank),
        "time_s": extreme.time,
        "phi_deg": math.degrees(extreme.angle),
    }


def _stroke_record(stroke: Stroke) -> dict[str, Any]:
    return {
        "crank_from_deg": math.degrees(stroke.start),
        "crank_to_deg": math.degrees(stroke.end),
        "duration_s": stroke.duration,
    }
