"""Writes docs/stability.md and its picture: `python docs/stability_page.py`.

Runs the whole suite of `python -m tests.stability`. A test compares the page with a quick run.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from pathlib import Path

from camgeo_export.plots import render
from tests.stability import suite
from tests.stability.measure import Case, Reading
from tests.stability.report import figure_of
from tests.stability.suite import Row

PAGE = Path(__file__).with_name("stability.md")
PICTURE = Path(__file__).with_name("images") / "stability.png"

HEAD = """# Stability

<!-- Made by docs/stability_page.py; change it there. -->

How many digits does camgeo lose by computing in doubles? `python -m tests.stability` measures it,
in a checkout: it computes every quantity of its suite twice, as camgeo does and with 80 digits by
independent formulas, and compares the results. It takes about {seconds} seconds and needs
`mpmath`; `--quick` evaluates two places of each case, `--only NAME` selects a group, a quantity
or a case, `-o stability.png` draws the picture below, `--json` prints the readings for programs.
Exit code 0 means that the limit is met.

## What is measured

The inputs of a case are doubles: cam angle, lengths, joints, boundary values. Each is taken as
exactly the number that it is. Each value is described by two figures, both in units in its last
place (ulp); for a vector, in ulp of its length.

- **error**: the distance of camgeo's value from the exact one.
- **conditioning**: how far the exact value moves if each input moves by half an ulp of its own,
  summed over all inputs. No algorithm can do better than that, because the inputs are rounded
  themselves. Joints are inputs too: degrees converted to radians and rounded once.

Their **ratio**, error / max(1, conditioning), judges the algorithm, not the problem: near 1, no
algorithm in doubles is better; a large ratio means that digits were lost which the inputs still
have. The limit is {limit:g}: fewer than 128 operations lie between the inputs and any quantity,
each with a rounding error of at most half an ulp.

Large errors with small ratios indicate hard problems, not bad algorithms. Where a value passes
through 0, at an inflection, a cusp or a dead centre, rounded inputs determine none of its digits;
there the ulp is that of the distance by which half an ulp of the inputs moves it, and errors of
1e15 are the rounding of the inputs.

## The exact values

The exact computation shares nothing with the engine but the inputs and initial guesses for roots. A
law is computed from its lift as printed in the guideline; derivatives come from Taylor series with
80 digits, never from differences. A cam is Z = W exp(-i sigma phi) with W from the follower's
geometry; under a flat face it is the envelope of the face's lines, where neighbouring lines
intersect by Cramer's rule. A linkage is closed by the law of cosines, or by Pythagoras for a slider
on its guide. Extremes, cusps and crossings are roots found by Newton's method: a crossing solves
W(x) = W(y) on the exact flank. The area of a disc is Green's integral by Gauss-Legendre quadrature,
the roller on a corner follows from Pythagoras or the law of cosines, the lever's angle is that of a
complex number, and a spline solves the equations that define it. `tests/stability` compares these
values with the hard cases and with independently written formulas.
"""

TABLE = """
## Results

Error, conditioning at that error, and ratio are the worst of all values: twice what was measured on
one machine (x86-64), rounded up to one digit, and never less than 2 ulp or a ratio of 1, because
other processors and libraries round sines differently. Error and ratio may belong to different
places.

| quantity | values | error [ulp] | conditioning [ulp] | ratio | largest error at |
|---|---|---|---|---|---|
"""

PICTURED = """
![Error against conditioning, with the lines of ratio 1 and of the limit](images/stability.png)

*Each point is the worst value of one quantity in one case. On the line of ratio 1 an error equals
the effect of half an ulp of the inputs.*
"""

CASES = """
## The cases

Cases with a name such as HC21c are [hard cases](hard-cases.md).
"""

MISSING = """
## What is not in the suite

- Laws for tasks other than rest to rest are represented by the polynomials with boundary values and
  the double harmonic; `tests/motion` compares every law of every task with 100 digits.
- Splines that smooth a table. A spline's values come from a system of equations, so its third
  derivative has the absolute accuracy of its largest value, even where it passes through 0, as at a
  free end.
- Lost stroke below a thousandth of the lift. It is the difference between what the follower does
  and what it should do, and is known to the rounding of these: 1e-15 of the lift. The lift on the
  outline is also measured near the ends of the missing part.
- Linkages on undercut cams, corners of pitch curves, replay on contours of lines and arcs, fits,
  files. Contours carry a proved bound instead; see [architecture.md](architecture.md).
"""

SECONDS = 25
"""Approximate duration of a run [s]."""

LEAST_ERROR, LEAST_RATIO = 2.0, 1.0

MARGIN = 2.0
"""The page claims this multiple of what was measured."""


def rounded_up(value: float) -> float:
    """To one digit, upwards."""
    if value == 0.0:
        return 0.0
    size = math.floor(math.log10(value))
    digit = math.ceil(value / 10.0**size * (1.0 - 1e-12))
    return float(f"{digit}e{size}")


def claimed_error(row: Row) -> float:
    """The error that the page claims [ulp]."""
    return rounded_up(max(MARGIN * row.largest_error.error, LEAST_ERROR))


def claimed_ratio(row: Row) -> float:
    """The ratio that the page claims, at most the limit."""
    return min(rounded_up(max(MARGIN * row.largest_ratio.ratio, LEAST_RATIO)), suite.LIMIT)


def number(value: float) -> str:
    """In full up to 1000, else as a power of ten."""
    return f"{value:g}" if value < 1e3 else f"{value:.0e}".replace("e+0", "e").replace("e+", "e")


def table_row(row: Row) -> str:
    """The line of a quantity."""
    worst = row.largest_error
    cells = (
        f"`{row.quantity}`",
        str(row.count),
        f"<= {number(claimed_error(row))}",
        number(rounded_up(worst.conditioning)),
        f"<= {number(claimed_ratio(row))}",
        worst.case,
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def page(cases: Iterable[Case], readings: Iterable[Reading]) -> str:
    """The page's text from the cases of the suite and their readings."""
    cases = tuple(cases)
    rows = {row.quantity: row for row in suite.table(readings)}
    quantities = dict.fromkeys(quantity for case in cases for quantity in case.quantities)
    parts = [HEAD.format(seconds=SECONDS, limit=suite.LIMIT), TABLE]
    parts += [table_row(rows[quantity]) for quantity in quantities]
    parts += [PICTURED, CASES]
    for group in suite.GROUPS:
        named = dict.fromkeys(case.name for case in cases if case.group == group)
        line = f"**{group}**: {'; '.join(named)}."
        parts.append(f"\n{textwrap.fill(line, 100, break_on_hyphens=False)}\n")
    return "".join((*parts, MISSING))


if __name__ == "__main__":
    everything = suite.all_cases()
    found = suite.run(everything)
    PAGE.write_text(page(everything, found), encoding="utf-8")
    PICTURE.write_bytes(render(figure_of(suite.worst_of_cases(found), suite.LIMIT), PICTURE.suffix))
