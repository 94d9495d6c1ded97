"""What `camgeo stability` finds: rounding errors and conditioning of every quantity."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from camgeo.app.answers.answer import BROKEN, FINE, Answer, Key
from camgeo.pictures.model import (
    AUXILIARY,
    Axis,
    Figure,
    Legend,
    Line,
    Panel,
    Style,
    box,
    entries,
    over,
)
from camgeo.pictures.model import (
    LIMIT as BROKEN_LINE,
)
from tests.stability import suite
from tests.stability.measure import Case, Reading
from tests.stability.suite import LIMIT, Row, worst_of_cases


@dataclass(frozen=True, slots=True)
class Stability(Answer):
    """The results of the comparison with mpmath.

    Attributes
    ----------
    readings : one for each value that was compared.
    rows : the quantities with their worst readings, the largest ratio first.
    quick : whether only two places of each case were compared.
    limit : of the ratio of error to conditioning.
    """

    command: ClassVar[str] = "stability"

    readings: tuple[Reading, ...]
    rows: tuple[Row, ...]
    quick: bool
    limit: float = LIMIT

    @property
    def kept(self) -> bool:
        """Whether all ratios are within the limit."""
        return all(row.within_limit for row in self.rows)

    @property
    def exit_code(self) -> int:
        """0 if all ratios are within the limit, else 1."""
        return FINE if self.kept else BROKEN


def stability(
    cases: Iterable[Case],
    only: Collection[str] = (),
    *,
    quick: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Stability:
    """Run cases of the suite; parameters as of `tests.stability.suite.run`."""
    readings = suite.run(cases, only, quick=quick, progress=progress)
    return Stability(readings, suite.table(readings), quick)


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


READING: Final = Key(
    "The worst value in this respect.",
    {
        "group": "Group of the case.",
        "case": "What was computed.",
        "at": "Place: `z` of a law, otherwise `cam_angle_deg` or `crank_angle_deg`.",
        "value": "The exact value, rounded; for a vector its length.",
        "error_ulp": Key(
            "Distance of camgeo's value from it, in units in its last place; null if camgeo gives"
            " none.",
            of="error",
            type=float | None,
        ),
        "conditioning_ulp": Key(
            "How far the exact value moves if each input moves by half a unit in its last place.",
            of="conditioning",
        ),
        "ratio": Key(
            "Ratio of error to conditioning, or to 1 where that is less; null if camgeo gives no"
            " value.",
            type=float | None,
        ),
    },
)

DOCUMENT: Final = Key(
    "Rounding errors and conditioning of every quantity, measured against mpmath.",
    {
        "quick": "Whether only two places of each case were compared.",
        "limit": "Limit of the ratio of error to conditioning.",
        "kept": "Whether all ratios are within the limit.",
        "quantities": Key(
            "The largest ratio first.",
            {
                "quantity": "Its name.",
                "values": Key("Number of its values that were compared.", of="count"),
                "largest_error": READING,
                "largest_ratio": READING,
            },
            of="rows",
        ),
    },
    type=Stability,
)


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo stability` finds, as a table and as a picture.


COLUMNS: Final = """\
values: number of values of the quantity that were compared with mpmath's
error: largest distance from the exact value, in units in its last place (ulp), or in that of its
    length for a vector; where rounding the inputs moves a value by more than its own size, in ulp
    of that movement
conditioning: by how many ulp the exact value moves there if each input moves by half an ulp of its
    own; the joints are inputs too, converted from degrees to radians and rounded once
at: case and place of that error: z of a law, cam angle or crank angle
ratio: largest error / max(1, conditioning); near 1 no algorithm in doubles can do better"""
"""The columns of the table, explained below it."""

NUMBER, WIDE = 9, 14
"""Widths of a column of numbers."""


def text(answer: Stability) -> str:
    """The table, an explanation of its columns, and what exceeds the limit."""
    width = max(len(row.quantity) for row in answer.rows) + 2
    places = [_place(row.largest_error) for row in answer.rows]
    second = max(map(len, places)) + 2
    head = f"{'quantity':{width}}{'values':>6}{'error':>{NUMBER}}{'conditioning':>{WIDE}}"
    lines = [f"{head}  {'at':{second}}{'ratio':>{NUMBER}}"]
    for row, place in zip(answer.rows, places, strict=True):
        worst = row.largest_error
        lines.append(
            f"{row.quantity:{width}}{row.count:>6}{_number(worst.error):>{NUMBER}}"
            f"{_number(worst.conditioning):>{WIDE}}  {place:{second}}"
            f"{_number(row.largest_ratio.ratio):>{NUMBER}}"
        )
    lines += ["", COLUMNS]
    lines.append(f"limit of the ratio {answer.limit:g}: {'kept' if answer.kept else 'broken'}")
    for row in answer.rows:
        worst = row.largest_ratio
        if not row.within_limit:
            lines.append(
                f"  {row.quantity}: ratio {_number(worst.ratio)} at {_place(worst)}, error"
                f" {_number(worst.error)}, conditioning {_number(worst.conditioning)}"
            )
    return "\n".join(lines)


def figure(answer: Stability) -> Figure:
    """Errors over conditioning, the worst of each case."""
    return figure_of(worst_of_cases(answer.readings), answer.limit)


def _number(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "no value"


def _place(reading: Reading) -> str:
    ((name, place),) = reading.at.items()
    return f"{reading.case}, {place:.9g}{' deg' if name != 'z' else ''}"


# -- picture ---------------------------------------------------------------------------------------

WIDTH, HEIGHT = 9.6, 9.0
LEFT, RIGHT, TOP, BOTTOM = 0.75, 2.75, 0.5, 0.6
"""Sizes [inch]; the legend stands in the right margin."""

LEAST: Final = 0.1
"""Errors and conditionings below this [ulp], zero included, are drawn at it."""

ROOM: Final = 3.0
"""Factor by which the axes extend beyond the points."""

COLOURS: Final = ("#12365c", "#c05a00", "#2e7d32", "#8e24aa", "#6d4c41", "#0097a7", "#9e9d24")

MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Every quantity has its own colour and marker; shapes differ for prints in grey."""


def figure_of(readings: Sequence[Reading], limit: float) -> Figure:
    """The readings as points, error against conditioning.

    Both in ulp on logarithmic axes. On the diagonal an error equals the effect of half an ulp of
    the inputs; left of 1 ulp the least possible error of a double replaces it.

    Parameters
    ----------
    readings : with finite errors.
    limit : the largest ratio that passes, drawn as a line.
    """
    points = []
    for number, quantity in enumerate(dict.fromkeys(reading.quantity for reading in readings)):
        own = [reading for reading in readings if reading.quantity == quantity]
        x = [max(reading.conditioning, LEAST) for reading in own]
        y = [max(reading.error, LEAST) for reading in own]
        points.append(Line(over(x, y), _style(number), quantity, layer=3.0))
    conditionings = [reading.conditioning for reading in readings]
    highest = ROOM * max([1.0, limit, *conditionings, *(reading.error for reading in readings)])
    low, high = LEAST / ROOM, ROOM * max([1.0, *conditionings])
    marks = (*points, *_lines(low, high, limit))
    panel = Panel(
        box(
            LEFT / WIDTH,
            BOTTOM / HEIGHT,
            1.0 - (LEFT + RIGHT) / WIDTH,
            1.0 - (BOTTOM + TOP) / HEIGHT,
        ),
        Axis((low, high), "conditioning: change by half an ulp of each input [ulp]", log=True),
        Axis((low, highest), "error against mpmath [ulp]", log=True),
        marks,
        "Rounding errors of the stability suite",
    )
    anchor = (1.0 - (RIGHT - 0.12) / WIDTH, 1.0 - TOP / HEIGHT)
    legend = Legend(entries(marks), "upper left", anchor, size=7.0, gap=0.0, spacing=0.35)
    return Figure((WIDTH, HEIGHT), (panel,), legend=legend)


def _style(number: int) -> Style:
    return Style(
        COLOURS[number % len(COLOURS)],
        0.0,
        marker=MARKERS[number % len(MARKERS)],
        size=4.0,
        edge="white",
        edge_width=0.3,
    )


def _lines(low: float, high: float, limit: float) -> list[Line]:
    """Ratio 1, and the limit."""
    x = np.sort(np.append(np.geomspace(low, high, 201), 1.0))
    floor = np.maximum(1.0, x)
    return [
        Line(over(x, floor), Style(AUXILIARY, 1.0), "ratio 1"),
        Line(
            over(x, limit * floor), Style(BROKEN_LINE, 1.0, (5.0, 3.0)), f"limit, ratio {limit:g}"
        ),
    ]
