"""Deviations over the cam angle: in a replay, of a measured disc, or by tolerances."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.geometry.outline.replay import Replay
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LEFT,
    LIMIT,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    ZERO,
    Axis,
    Band,
    Box,
    Figure,
    Fill,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    Text,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.studies.inspection import Deviations, LiftErrors
from camgeo.studies.tolerancing.linear import QUANTILES, Linear, Sampled
from camgeo.units import counted

# -- replay ---------------------------------------------------------------------------------------
# A replay: lift and lost stroke, velocity, acceleration and its ripple.


REPLAY_SIZE: Final = (7.0, 7.8)

REPLAY_BOTTOM: Final = 0.8
"""Lower margin [inch], with room for the legend."""

ACTUAL: Final = Style(LINE, 1.1)
DEMANDED: Final = Style(AUXILIARY, 1.4, (5.0, 3.0))
LOST: Final = Fill(LIMIT, LIMIT, 0.0, opacity=0.35)
SHOCK: Final = Style(LIMIT, 0.0, marker="^", size=3.5)

FOOT: Final = 0.03
"""Height at which shocks are marked, as a fraction of the panel's height."""

MOST: Final = 3.0
"""The acceleration is drawn up to this multiple of its prescribed peak: a corner's spike beyond it
would flatten everything else."""

SHARE: Final = 0.05
"""Lost stroke below this fraction of the lift's range is too thin to be visible as an area."""


def replay_figure(
    replay: Replay, *, title: str, unit: str, scale: float, joints: tuple[float, ...]
) -> Figure:
    """The lift and two derivatives, demanded and actual, one panel each.

    Parameters
    ----------
    unit, scale : unit of the drawn lift, and how many of it make 1 mm or 1 rad.
    joints : cam angles [rad] to mark.
    """
    unit = "°" if unit == "deg" else unit
    panels = []
    marked: list[Mark] = []
    for order, frame in enumerate(
        grid(REPLAY_SIZE, (*MARGINS[:3], REPLAY_BOTTOM), 3, gaps=(0.12, 0.0))
    ):
        y_limits, marks = _replay_panel(replay, order, scale, unit)
        marked += marks
        symbol = ("ψ" if unit == "°" else "s") + ("", "′", "″")[order]
        per = ("", "/rad", "/rad²")[order]
        panels.append(
            Panel(
                frame,
                turn_axis(numbered=order == 2),
                Axis(y_limits, f"{symbol} [{unit}{per}]"),
                (*marks, *joint_marks(joints)),
                title=title if order == 0 else "",
                title_size=10.0,
            )
        )
    named = tuple(dict.fromkeys(entries(marked)))
    return Figure(
        REPLAY_SIZE, tuple(panels), legend=Legend(named, "lower center", None, len(named))
    )


def _replay_panel(
    replay: Replay, order: int, scale: float, unit: str
) -> tuple[tuple[float, float], list[Mark]]:
    """Limits of the vertical axis, and marks, for the derivative of that order."""
    phi = np.degrees(replay.phi)
    seen = replay.smooth if order == 2 else np.ones(len(phi), dtype=bool)
    demanded, actual = replay.demanded[order] * scale, replay.actual[order] * scale
    y_limits = limits([0.0, actual[seen], demanded])
    marks: list[Mark] = [
        ZERO,
        Line(over(phi[seen], actual[seen]), ACTUAL, "actual"),
        Line(over(phi, demanded), DEMANDED, "demanded"),
    ]
    if order == 0:
        loss = replay.largest_loss.value * scale
        marks += _lost(replay, phi, demanded, actual)
        marks.append(_note(f"lost stroke up to {loss:.3g} {unit}"))
    elif order == 1 and len(replay.shocks):
        count = len(replay.shocks.phi)
        foot = y_limits[0] + FOOT * (y_limits[1] - y_limits[0])
        places = over(np.degrees(replay.shocks.phi), np.full(count, foot))
        marks.append(Line(places, SHOCK, "shock"))
        marks.append(_note(counted(count, "shock")))
    elif order == 2:
        if replay.ripple is not None:
            share = 100.0 * replay.ripple
            text = f"{share:.0f}" if share >= 100.0 else f"{share:.3g}"
            marks.append(_note(f"ripple {text} % of the demanded peak"))
        peak = replay.demanded_acceleration * scale
        if peak > 0.0 and float(np.max(np.abs(actual[seen]))) > MOST * peak:
            y_limits = -MOST * peak, MOST * peak  # keeps spikes from flattening the curve
    return y_limits, marks


def _lost(replay: Replay, phi: FloatArray, demanded: FloatArray, actual: FloatArray) -> list[Mark]:
    """The area of lost stroke, if it is large enough to be visible."""
    span = float(np.ptp(demanded))
    if not (span > 0.0 and float(np.max(np.abs(actual - demanded))) > SHARE * span):
        return []
    low, high = (np.where(replay.lost > 0.0, lift, np.nan) for lift in (demanded, actual))
    return [Band("x", phi, low, high, LOST, "lost stroke")]


def _note(text: str) -> Text:
    return Text(text, (0.99, 0.94), 8.0, "panel", across="right", up="top", box=Box(1.0))


# -- inspection ------------------------------------------------------------------------------------
# A measured flank over the cam angle: its deviations, and the error of the lift.


FLANK_SIZE: Final = (7.0, 5.6)
FLANK_ALONE: Final = (7.0, 3.4)
"""Size without the panel of lift errors."""

FLANK_LEFT: Final = 0.95
"""Left margin [inch], with room for numbers with many digits."""

MEASURED: Final = Style(LINE, 0.9, marker="o", size=2.0)
ERROR: Final = Style(AUXILIARY, 1.2)

GAP: Final = 10.0
"""Range of cam angle [degrees] without points over which no line is drawn."""

Scale = tuple[str, float]
"""A unit, and how many of it make 1 mm or 1 rad."""


def inspection_figure(
    deviations: Deviations,
    lift: LiftErrors | None,
    *,
    title: str,
    unit: Scale,
    lift_unit: Scale,
    tolerance: float | None,
    joints: tuple[float, ...],
) -> Figure:
    """Deviations, positive for too much material, with the allowed zone, and lift errors.

    Parameters
    ----------
    tolerance : width of the zone [mm].
    joints : cam angles [rad] to mark.
    """
    name, scale = unit
    order = np.argsort(deviations.places.phi, kind="stable")
    values = deviations.values[order] * scale
    rules = [] if tolerance is None else [0.5 * tolerance * scale, -0.5 * tolerance * scale]
    phi = np.degrees(deviations.places.phi[order])
    # A NaN is a gap in a line: no straight line is drawn over a range without points.
    wide = np.flatnonzero(np.diff(phi) > GAP) + 1
    points = over(np.insert(phi, wide, np.nan), np.insert(values, wide, np.nan))
    marks: list[Mark] = [
        ZERO,
        Line(points, MEASURED, "measured"),
        *(Rule("y", level, LIMIT_STYLE, "allowed" * (level > 0.0)) for level in rules),
    ]
    rows = 1 if lift is None else 2
    size = FLANK_ALONE if lift is None else FLANK_SIZE
    frames = grid(size, (FLANK_LEFT, *MARGINS[1:]), rows, gaps=(0.12, 0.0))
    first = Panel(
        frames[0],
        turn_axis(numbered=lift is None),
        _axis(values, rules, f"deviation [{name}]"),
        (*marks, *joint_marks(joints)),
        title=title,
        title_size=9.0,
        legend=Legend(entries(marks)),
    )
    if lift is None:
        return Figure(size, (first,))
    name, scale = lift_unit
    errors = lift.errors * scale
    second = Panel(
        frames[1],
        turn_axis(),
        _axis(errors, [], f"lift error [{'°' if name == 'deg' else name}]"),
        (ZERO, Line(over(np.degrees(lift.phi), errors), ERROR), *joint_marks(joints)),
    )
    return Figure(size, (first, second), aligned=True)


def _axis(values: FloatArray, rules: list[float], label: str) -> Axis:
    return Axis(limits([[0.0], values], rules), label, powers=(-2, 3))


# -- tolerance -------------------------------------------------------------------------------------
# A tolerance analysis over the cam angle: the band of errors, and the variance by source.


TOLERANCE_SIZE: Final = (8.6, 6.4)

TOLERANCE_RIGHT: Final = 2.2
"""Right margin [inch], with room for the names of the sources."""

SIGMA_BAND: Final = Fill(LINE, LINE, 0.0, opacity=0.2)
MEAN: Final = Style(LINE, 1.2)
EDGE: Final = Style(AUXILIARY, 1.0, (1.0, 1.5))

FACES: Final = (
    "#12365c", "#e0a458", "#5b8e7d", "#b3541e", "#8cb4d6", "#7a5195", "#c9c27a", "#a0a0a0",
)  # fmt: skip
"""Colours of the sources, in turn; neighbours differ in lightness."""

HATCHED: Final = len(FACES)
"""Number of the first source that is hatched, as colours repeat from there."""


def tolerance_figure(
    linear: Linear, sampled: Sampled | None, name: str, *, unit: str, factor: float
) -> Figure:
    """The mean error with three standard deviations, and below it the share of each source.

    Parameters
    ----------
    sampled : random machines, whose quantiles are drawn; None if there are none.
    unit, factor : unit of the drawn errors, and how many of it make 1 mm or 1 rad.
    """
    upper, lower = grid(TOLERANCE_SIZE, (LEFT, TOLERANCE_RIGHT, *MARGINS[2:]), 2, gaps=(0.12, 0.0))
    joints = linear.stated.machine.cam.drive.joints
    sign = "°" if unit == "deg" else unit
    y_limits, marks = _errors(linear, sampled, factor)
    errors = Panel(
        upper, turn_axis(numbered=False), Axis(y_limits, f"error of the position [{sign}]"),
        (*marks, *joint_marks(joints)), f"{name}: tolerances", title_size=10.0,
        legend=_right_legend(marks),
    )  # fmt: skip
    stack = _shares(linear)
    shares = Panel(
        lower, turn_axis(), Axis((0.0, 100.0), "share of the variance [%]"),
        (*stack, *joint_marks(joints)), legend=_right_legend(stack[::-1]),
    )  # fmt: skip
    return Figure(TOLERANCE_SIZE, (errors, shares))


def _right_legend(marks: list[Mark]) -> Legend:
    """The legend of marks, on the right of their panel."""
    return Legend(entries(marks), "upper left", (1.02, 1.0), size=7.5, gap=0.0)


def _round(values: FloatArray) -> FloatArray:
    """The values with the first one repeated at the end, so that curves close at 360 degrees."""
    return np.append(values, values[0])


def _errors(
    linear: Linear, sampled: Sampled | None, factor: float
) -> tuple[tuple[float, float], list[Mark]]:
    phi = np.append(np.degrees(linear.angles), 360.0)
    mean, low, high = (_round(values) * factor for values in (linear.mean, *linear.band))
    marks: list[Mark] = [
        ZERO,
        Band("x", phi, low, high, SIGMA_BAND, "mean ± 3 sigma"),
        Line(over(phi, mean), MEAN, "mean"),
    ]
    if sampled is not None:
        low_share, _, high_share = QUANTILES
        for values, label in zip(
            sampled.quantiles[[0, -1]],
            (f"{low_share:.0%} and {high_share:.0%} of machines", ""),
            strict=True,
        ):
            marks.append(Line(over(phi, _round(values) * factor), EDGE, label))
    limit = linear.stated.limit
    rules = [] if limit is None else [-limit * factor, limit * factor]
    for place, label in zip(rules, ("limit", ""), strict=False):
        marks.append(Rule("y", place, LIMIT_STYLE, label))
    return limits([0.0, low, high], rules), marks


def _shares(linear: Linear) -> list[Mark]:
    """The shares of the variance as stacked areas, the first source at the bottom."""
    phi = np.append(np.degrees(linear.angles), 360.0)
    total = np.sum(linear.variances, axis=0)
    parts = np.divide(
        linear.variances, total, out=np.zeros_like(linear.variances), where=total > 0.0
    )
    edges = 100.0 * np.vstack((np.zeros_like(total), np.cumsum(parts, axis=0)))
    bands: list[Mark] = []
    for k, source in enumerate(linear.stated.sources):
        fill = Fill(FACES[k % len(FACES)], "white", 0.4, hatched=k >= HATCHED)
        low, high = (_round(edge) for edge in edges[k : k + 2])
        bands.append(Band("x", phi, low, high, fill, source.name))
    return bands
