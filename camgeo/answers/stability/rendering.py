"""What `camgeo stability` finds, as a table and as a picture."""

from __future__ import annotations

import math
from typing import Final

from camgeo.answers.stability import Stability
from camgeo.figure import stability
from camgeo.figure.model import Figure
from camgeo.stability.measure import Reading
from camgeo.stability.suite import worst_of_cases

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
    return stability.figure(worst_of_cases(answer.readings), answer.limit)


def _number(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "no value"


def _place(reading: Reading) -> str:
    ((name, place),) = reading.at.items()
    return f"{reading.case}, {place:.9g}{' deg' if name != 'z' else ''}"
