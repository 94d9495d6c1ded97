"""A replay over the cam angle: lift and lost stroke, velocity, acceleration and its ripple."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.geometry.outline.replay import Replay
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
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
    Style,
    Text,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.units import counted

SIZE: Final = (7.0, 7.8)

BOTTOM: Final = 0.8
"""Margin [inch] with room for the legend."""

ACTUAL: Final = Style(LINE, 1.1)
DEMANDED: Final = Style(AUXILIARY, 1.4, (5.0, 3.0))
LOST: Final = Fill(LIMIT, LIMIT, 0.0, opacity=0.35)
SHOCK: Final = Style(LIMIT, 0.0, marker="^", size=3.5)

FOOT: Final = 0.03
"""Where shocks are marked, as a fraction of the panel's height."""

MOST: Final = 3.0
"""The acceleration is drawn up to this multiple of its prescribed peak: a corner's spike beyond it
would flatten everything else."""

SHARE: Final = 0.05
"""Lost stroke below this fraction of the lift's range is too thin to be visible as an area."""


def figure(
    replay: Replay, *, title: str, unit: str, scale: float, joints: tuple[float, ...]
) -> Figure:
    """The lift and two derivatives, prescribed and actual.

    Parameters
    ----------
    unit, scale : of the drawn lift, and units per mm or rad.
    joints : cam angles [rad] to mark.
    """
    unit = "°" if unit == "deg" else unit
    panels = []
    marked: list[Mark] = []
    for order, frame in enumerate(grid(SIZE, (*MARGINS[:3], BOTTOM), 3, gaps=(0.12, 0.0))):
        shown, marks = _panel(replay, order, scale, unit)
        marked += marks
        symbol = ("ψ" if unit == "°" else "s") + ("", "′", "″")[order]
        per = ("", "/rad", "/rad²")[order]
        panels.append(
            Panel(
                frame,
                turn_axis(numbered=order == 2),
                Axis(shown, f"{symbol} [{unit}{per}]"),
                (*marks, *joint_marks(joints)),
                title=title if order == 0 else "",
                title_size=10.0,
            )
        )
    named = tuple(dict.fromkeys(entries(marked)))
    return Figure(SIZE, tuple(panels), legend=Legend(named, "lower center", None, len(named)))


def _panel(
    replay: Replay, order: int, scale: float, unit: str
) -> tuple[tuple[float, float], list[Mark]]:
    """Limits and marks of the derivative of that order."""
    phi = np.degrees(replay.phi)
    seen = replay.smooth if order == 2 else np.ones(len(phi), dtype=bool)
    demanded, actual = replay.demanded[order] * scale, replay.actual[order] * scale
    shown = limits([0.0, actual[seen], demanded])
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
        foot = shown[0] + FOOT * (shown[1] - shown[0])
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
            shown = -MOST * peak, MOST * peak  # keeps spikes from flattening the curve
    return shown, marks


def _lost(replay: Replay, phi: FloatArray, demanded: FloatArray, actual: FloatArray) -> list[Mark]:
    span = float(np.ptp(demanded))
    if not (span > 0.0 and float(np.max(np.abs(actual - demanded))) > SHARE * span):
        return []
    low, high = (np.where(replay.lost > 0.0, each, np.nan) for each in (demanded, actual))
    return [Band("x", phi, low, high, LOST, "lost stroke")]


def _note(text: str) -> Text:
    return Text(text, (0.99, 0.94), 8.0, "panel", across="right", up="top", box=Box(1.0))
