"""A tolerance analysis over the cam angle: the band of errors, and the variance by source."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LEFT,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    ZERO,
    Axis,
    Band,
    Figure,
    Fill,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.studies.tolerancing.linear import QUANTILES, Linear, Sampled

SIZE: Final = (8.6, 6.4)

RIGHT: Final = 2.2
"""Margin [inch] with room for the names of the sources."""

WITHIN: Final = Fill(LINE, LINE, 0.0, opacity=0.2)
MEAN: Final = Style(LINE, 1.2)
EDGE: Final = Style(AUXILIARY, 1.0, (1.0, 1.5))

FACES: Final = (
    "#12365c", "#e0a458", "#5b8e7d", "#b3541e", "#8cb4d6", "#7a5195", "#c9c27a", "#a0a0a0",
)  # fmt: skip
"""Of the sources, in turn; neighbours differ in lightness."""

HATCHED: Final = len(FACES)
"""Sources from this one on are hatched."""


def of_analysis(
    linear: Linear, sampled: Sampled | None, name: str, *, unit: str, factor: float
) -> Figure:
    """Mean error with three standard deviations, and below the share of each source.

    Parameters
    ----------
    sampled : random machines, of which quantiles are drawn, if there are any.
    unit, factor : of the drawn errors, and units per mm or rad.
    """
    upper, lower = grid(SIZE, (LEFT, RIGHT, *MARGINS[2:]), 2, gaps=(0.12, 0.0))
    joints = linear.stated.machine.cam.drive.joints
    sign = "°" if unit == "deg" else unit
    shown, marks = _errors(linear, sampled, factor)
    errors = Panel(
        upper, turn_axis(numbered=False), Axis(shown, f"error of the position [{sign}]"),
        (*marks, *joint_marks(joints)), f"{name}: tolerances", title_size=10.0,
        legend=_beside(marks),
    )  # fmt: skip
    stack = _shares(linear)
    shares = Panel(
        lower, turn_axis(), Axis((0.0, 100.0), "share of the variance [%]"),
        (*stack, *joint_marks(joints)), legend=_beside(stack[::-1]),
    )  # fmt: skip
    return Figure(SIZE, (errors, shares))


def _beside(marks: list[Mark]) -> Legend:
    return Legend(entries(marks), "upper left", (1.02, 1.0), size=7.5, gap=0.0)


def _round(values: FloatArray) -> FloatArray:
    """Closed over the turn."""
    return np.append(values, values[0])


def _errors(
    linear: Linear, sampled: Sampled | None, factor: float
) -> tuple[tuple[float, float], list[Mark]]:
    phi = np.append(np.degrees(linear.angles), 360.0)
    mean, low, high = (_round(each) * factor for each in (linear.mean, *linear.band))
    marks: list[Mark] = [
        ZERO,
        Band("x", phi, low, high, WITHIN, "mean ± 3 sigma"),
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
    """A stack of areas, the first source at the bottom."""
    phi = np.append(np.degrees(linear.angles), 360.0)
    total = np.sum(linear.variances, axis=0)
    parts = np.divide(
        linear.variances, total, out=np.zeros_like(linear.variances), where=total > 0.0
    )
    edges = 100.0 * np.vstack((np.zeros_like(total), np.cumsum(parts, axis=0)))
    found: list[Mark] = []
    for k, source in enumerate(linear.stated.sources):
        fill = Fill(FACES[k % len(FACES)], "white", 0.4, hatched=k >= HATCHED)
        low, high = (_round(each) for each in edges[k : k + 2])
        found.append(Band("x", phi, low, high, fill, source.name))
    return found
