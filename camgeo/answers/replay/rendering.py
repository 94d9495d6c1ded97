"""What `camgeo replay` finds, in words, as a table and as a picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.answers.replay import DiscReplay, FollowerReplay
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.outline.replay_result import play
from camgeo.product.value_table import Table, cam_angles

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

WIDTH: Final = 22
"""Of the names."""

TOUCHING: Final = 1e-9
"""Rollers that are squeezed by up to this [mm] touch: rounding."""


def text(answer: FollowerReplay) -> str:
    """What the follower does on each disc, and how a pair closes."""
    lines = []
    for each in answer.discs:
        what = each.disc.cam.follower.touching
        lines.append(f"{each.disc.name}: the {what} on {each.contour}, {answer.flank} flank")
        lines += _lines(each)
    if answer.closing is not None:
        lines += [f"{answer.scene.name}: both discs", *_closing_lines(answer.closing)]
    return "\n".join(lines)


def table(answer: FollowerReplay) -> Table:
    """One row for every step of the cam angle, right-hand values; of a pair with the play."""
    first = answer.discs[0]
    degrees = cam_angles(answer.step)
    phi: FloatArray = np.radians(degrees)
    lift, unit = first.replay.lift, first.unit
    demanded = lift.motion.jet(phi, "right", 2) * first.factor
    actual = lift.jet(phi) * first.factor
    columns = {
        "phi [deg]": degrees,
        f"s demanded [{unit}]": demanded[0],
        f"s [{unit}]": actual[0],
        f"difference [{unit}]": actual[0] - demanded[0],
        f"s' [{unit}/rad]": actual[1],
        f"s'' [{unit}/rad^2]": actual[2],
        f"s' demanded [{unit}/rad]": demanded[1],
        f"s'' demanded [{unit}/rad^2]": demanded[2],
    }
    if answer.closing is not None:
        main, other = (each.replay for each in answer.discs)
        columns[f"play [{unit}]"] = play(main, other, phi) * first.factor
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def figure(answer: FollowerReplay) -> Figure:
    """Lift, velocity and acceleration on the first disc."""
    from camgeo.figure import replay

    first = answer.discs[0]
    return replay.figure(
        first.replay,
        title=f"{first.disc.name}: replay, {answer.flank} flank, {first.contour}",
        unit=first.unit,
        scale=first.factor,
        joints=first.disc.cam.drive.joints,
    )


def _lines(disc: DiscReplay) -> list[str]:
    """What the follower does, a line each."""
    unit = disc.unit
    lines = [_line("lost stroke", _at(disc.lost_stroke, unit))]
    lines.append(_line("lift error", _at(disc.lift_error, unit)))
    for name, peak, per in (
        ("velocity", disc.velocity, "rad"),
        ("acceleration", disc.acceleration, "rad^2"),
    ):
        actual = "unbounded" if peak.actual is None else _at(peak.actual, f"{unit}/{per}")
        lines.append(_line(name, f"{actual}; demanded {peak.demanded:.6g}"))
    if disc.ripple is not None:
        share = f"{_percent(disc.ripple.value)} of the demanded peak acceleration"
        lines.append(_line("ripple", f"{share}, at {_place(disc.ripple)}"))
    shocks, largest = "none", disc.shocks.largest
    if largest is not None:
        shocks = f"{len(disc.shocks)}, the largest {_at(largest, f'{unit}/rad')}"
        if disc.replay.largest_shock is not None:
            shocks += f", {_percent(disc.replay.largest_shock)} of the demanded peak velocity"
    lines.append(_line("shocks", shocks))
    if (drop := disc.drops.largest) is not None:
        count = len(disc.drops)
        often = "once," if count == 1 else f"{count} times, the largest"
        lines.append(_line("falls off an edge", f"{often} {_at(drop, unit)}"))
    if (contact := disc.contact) is not None:
        ends = " to ".join(_at(each, "mm") for each in (contact.lowest, contact.highest))
        beyond = "; it leaves the face, as if it were longer" if contact.leaves_face else ""
        lines.append(_line("contact on the face", f"{ends}{beyond}"))
    if (timed := disc.in_time) is not None:
        for name, per in (("velocity", "s"), ("acceleration", "s^2")):
            actual, demanded = (f"{timed[f'{of}_{name}']:.6g}" for of in ("actual", "demanded"))
            lines.append(_line(f"{name} in time", f"{actual} {unit}/{per}; demanded {demanded}"))
    return lines


def _closing_lines(closing: Extremes) -> list[str]:
    """Play, and squeeze where it is negative."""
    lines = []
    for name, each in (("largest play", closing.highest), ("smallest play", closing.lowest)):
        tail = ": the rollers are squeezed there" if each.value < -TOUCHING else ""
        lines.append(_line(name, f"{_at(each, 'mm')}, as travel of the main roller{tail}"))
    return lines


def _line(name: str, text: str) -> str:
    return f"{name:{WIDTH}}{text}"


def _at(extreme: Extreme, unit: str) -> str:
    return f"{extreme.value:.6g} {unit} at {_place(extreme)}"


def _place(extreme: Extreme) -> str:
    return f"cam angle {math.degrees(extreme.place):.6g} deg"


def _percent(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.0f} %" if percent >= 100.0 else f"{percent:.3g} %"
