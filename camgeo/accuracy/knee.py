"""The knee: among the contours of one form, the tolerance beyond which more cost gains nothing.

Each decade of accuracy multiplies the pieces by 10^(1/k), k = 2, 3, 4 for chords, arcs and cubics;
a power law has no knee. What the pieces are for has some, and the knee is where the first of these
ends:

- time: a contour is milled in at most 5 % more time than the quickest one; beyond it, blocks become
  too short for the feed, which costs minutes of machining;
- decimals: its program has no more decimals than the loosest one: a program has at least the
  controller's number of decimals, and beyond that the printed numbers set the limit, not the
  contour;
- ripple: the error of the acceleration in a replay, if it was requested, falls by at least 5 %, or
  benefit: at a speed of the cam, if one was asked for, a tighter contour changes one of the figures
  of `camgeo.accuracy.enough` by more than 5 %;
- cost, where none of these two is known: what a contour costs, the geometric mean of its pieces, of
  the bytes of its drawing and of the seconds to fit, prove, write and read that, is at most two
  steps of a factor 1.5 above the cheapest. Bytes and seconds have a constant part, and while that
  is the larger one, accuracy adds little to them; beyond it, each decade multiplies everything.

Where none of them ends within the tolerances that were measured, that is said: the end of a range
is no knee.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from camgeo.accuracy.rows import ContourRow, FileCost
from camgeo.contour.contour import Form
from camgeo.wording import counted

if TYPE_CHECKING:
    from camgeo.accuracy.benefit import BenefitRow

SLACK: Final = 1.05
"""Machining times and ripples up to this factor of the best count as the best: feed override and
rounding of a plan change them more."""

STEP: Final = 1.5
"""Factor by which costs must differ to be told apart: two runs on a busy machine differ by less."""

STEPS: Final = 2
"""Of that factor by which a contour may cost more than the cheapest one."""

LEAST_TIME: Final = 5e-4
"""Difference of computing times [s] below which there is none."""

NAMES: Final[dict[Form, str]] = {
    "polyline": "straight pieces",
    "arcs": "arcs",
    "spline": "a spline",
}

End = Literal["time", "decimals", "ripple", "benefit", "cost", "reach", "range"]

BEYOND: Final[dict[End, str]] = {
    "time": "tighter contours are milled more slowly, their blocks are too short for the feed",
    "ripple": "tighter contours run no smoother",
    "benefit": "tighter ones change what the follower does by at most 5 %",
    "cost": f"tighter ones cost more than {STEP**STEPS:g} times as much as the cheapest",
    "reach": "tighter tolerances cannot be reached",
    "range": "that is the end of what was tried, not a knee",
}
"""What is said of tighter tolerances; of decimals, it is how many."""


@dataclass(frozen=True, slots=True)
class Knee:
    """The recommendation, and which benefit ends beyond it.

    Attributes
    ----------
    row : the recommended contour.
    end : what a tighter tolerance loses, see above; "reach" if it cannot be reached, "range" if
        none was measured.
    quick : with milling the tightest tolerance [mm] that is milled in at most 5 % more than the
        least time; None without.
    step : the same contour at two tolerances, the last step up to the knee, or the first one beyond
        it if there is none; empty if there is no other.
    bought : by which share of the peak of the acceleration the second of them is less off than the
        first; None if that is not known.
    """

    row: ContourRow
    end: End
    quick: float | None
    step: tuple[ContourRow, ...] = ()
    bought: float | None = None


def knee_of(
    rows: Sequence[ContourRow], benefits: Sequence[BenefitRow] = (), *, timed: bool = True
) -> Knee | None:
    """The knee of `rows` of one form and effort, the loosest first; None if nothing can be reached.

    Parameters
    ----------
    benefits : of that form at one speed of the cam, if they are known.
    timed : whether seconds of computing count, which are those of one machine.
    """
    known = [row for row in rows if row.count is not None and row.drawing is not None]
    if not known:
        return None
    milled = any(row.decimals is not None for row in known)
    rounds = {row.tolerance: row.round_seconds for row in known if milled}
    quick = _tightest(rounds, SLACK)
    limits: list[tuple[float | None, End]] = [
        (quick, "time"),
        (_tightest({row.tolerance: row.decimals for row in known}, 1.0), "decimals"),
    ]
    ripples = {row.tolerance: row.ripple for row in known if row.ripple is not None}
    off = {row.tolerance: row.ripple for row in benefits if row.ripple is not None} or ripples
    if ripples:
        least = min(ripples.values())
        limits.append((max(t for t, each in ripples.items() if each <= SLACK * least), "ripple"))
    if benefits:
        from camgeo.accuracy.enough import enough  # a survey without a speed needs none

        found = enough(benefits)
        limits.append((None if found is None else found.row.tolerance, "benefit"))
    if not off:
        costs = {row.tolerance: _cost(row, timed=timed) for row in known}
        limits.append((_tightest(costs, STEP**STEPS), "cost"))
    tightest, end = max(
        ((limit, name) for limit, name in limits if limit is not None), key=lambda pair: pair[0]
    )
    number = max(k for k, row in enumerate(known) if row.tolerance >= tightest)
    if number == len(known) - 1:
        end = "reach" if rows[-1].tolerance < known[-1].tolerance else "range"
    step = tuple(known[number - 1 : number + 1] if number else known[:2])
    ends = [off[row.tolerance] for row in step if row.tolerance in off]
    bought = ends[0] - ends[1] if len(ends) > 1 else None
    return Knee(known[number], end, quick, step if len(step) > 1 else (), bought)


def _tightest(costs: Mapping[float, float | None], factor: float) -> float | None:
    """The tightest tolerance whose cost is at most `factor` times the least one; None if costs are
    not known.
    """
    known = {tolerance: cost for tolerance, cost in costs.items() if cost is not None}
    if not known:
        return None
    most = factor * min(known.values())
    return min(tolerance for tolerance, cost in known.items() if cost <= most)


def _cost(row: ContourRow, *, timed: bool) -> float:
    """The geometric mean of what a contour costs; only ratios of it mean something."""
    costs = [_pieces(row), _drawing(row).size, *([_drawing(row).seconds] if timed else [])]
    return math.prod(costs) ** (1.0 / len(costs))


def advice(knee: Knee | None) -> str:
    """The sentence for a knee, without seconds of computing; for None, that none can be reached."""
    if knee is None:
        return "none of these tolerances can be reached"
    row = knee.row
    head = f"{NAMES[row.form]} ({row.effort}) within {row.tolerance:g} mm"
    costs = [counted(_pieces(row), "piece"), f"drawing of {counted(_drawing(row).size, 'byte')}"]
    if knee.quick is not None and row.round_seconds is not None:
        costs.append(f"milled round in {row.round_seconds:.1f} s")
    if row.ripple is not None:
        costs.append(f"ripple {100.0 * row.ripple:.2g} %")
    return f"{head}: {', '.join(costs)}; {_beyond(knee)}"


def _beyond(knee: Knee) -> str:
    """What a tighter tolerance costs, or why there is none."""
    if knee.end != "decimals":
        return BEYOND[knee.end]
    down = "" if knee.quick is None else f" are no slower down to {knee.quick:g} mm, but"
    return (
        f"tighter programs{down} need more decimals than {knee.row.decimals}, which the machine is"
        " not known to resolve"
    )


def step_sentence(knee: Knee | None) -> str:
    """What the step of a knee costs and buys, in words; empty if there is none."""
    if knee is None or not knee.step:
        return ""
    loose, tight = knee.step
    pieces, size = _pieces(tight) - _pieces(loose), _drawing(tight).size - _drawing(loose).size
    seconds = _drawing(tight).seconds - _drawing(loose).seconds
    parts = [counted(pieces, "piece"), "no time" if seconds < LEAST_TIME else _time(seconds)]
    text = f"{', '.join(parts)} and {_digits(size / 1e3)} kB"
    if loose.round_seconds is not None and tight.round_seconds is not None:
        longer = tight.round_seconds - loose.round_seconds
        same = abs(longer) <= (SLACK - 1.0) * loose.round_seconds
        more = f"{abs(longer):.1f} s {'longer' if longer > 0.0 else 'shorter'}"
        text += f", machining {'the same' if same else more}"
    if knee.bought is not None:
        share = f"{100.0 * knee.bought:.2g} %" if knee.bought > 0.0 else "nothing"
        text += f", and buys {share} of the acceleration"
    return f"from {loose.tolerance:g} mm to {tight.tolerance:g} mm costs {text}"


def _time(seconds: float) -> str:
    return f"{_digits(1e3 * seconds)} ms" if seconds < 1.0 else f"{_digits(seconds)} s"


def _digits(value: float) -> str:
    """Two digits, the units at least."""
    return f"{value:,.0f}" if abs(value) >= 9.95 else f"{value:.2g}"


def _drawing(row: ContourRow) -> FileCost:
    assert row.drawing is not None  # checked before
    return row.drawing


def _pieces(row: ContourRow) -> int:
    assert row.count is not None  # checked before
    return row.count.pieces
