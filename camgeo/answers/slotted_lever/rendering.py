"""What `camgeo slotted-lever` finds, in words, as a table and as a diagram."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from camgeo.answers.slotted_lever import LeverMotion
from camgeo.mechanism.slotted_lever_drive import LeverExtreme
from camgeo.units import RPM

if TYPE_CHECKING:
    from camgeo.figure.model import Figure
    from camgeo.product.value_table import Table

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
    from camgeo.figure import slotted_lever

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
