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
  of `camgeo.studies.accuracy.knee` by more than 5 %;
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
from typing import Final, Literal

from camgeo.geometry.contour.contour import Form
from camgeo.studies.accuracy.benefit import BenefitRow
from camgeo.studies.accuracy.contours import FORMS, ContourRow, FileCost
from camgeo.units import counted

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


# -- enough ---------------------------------------------------------------------------------------
# Which tolerance is enough at one speed of the cam: beyond it, the cam runs no better.
#
# Of the contours of one form the loosest is enough from which on each tighter one, of those
# measured, changes none of three benefits by more than `SHARE` of the exact motion's figure: the
# deviation of the acceleration, that of the contact force, and the lift-off speed.


SHARE: Final = 0.05
"""Change of a benefit, relative to the exact motion, that is worth nothing."""


@dataclass(frozen=True, slots=True)
class Enough:
    """The contour that is enough.

    Attributes
    ----------
    row : of it.
    gain : largest share by which a tighter one of those measured changes a benefit; 0 if there is
        none.
    last : whether it is the tightest one measured, so that a tighter one may be worth it.
    """

    row: BenefitRow
    gain: float
    last: bool


def enough(rows: Sequence[BenefitRow]) -> Enough | None:
    """The contour that is enough, of `rows` of one form and speed; None if none has values."""
    known = sorted(
        (row for row in rows if row.acceleration is not None),
        key=lambda row: row.tolerance,
        reverse=True,
    )
    for number, row in enumerate(known):
        gain = max((change(row, other) for other in known[number + 1 :]), default=0.0)
        if gain <= SHARE:
            return Enough(row, gain, last=number == len(known) - 1)
    return None


def change(row: BenefitRow, other: BenefitRow) -> float:
    """The largest change of a benefit from one contour to another, relative to the exact motion."""
    figures = (
        (row.acceleration, other.acceleration, row.exact_acceleration),
        (row.force, other.force, row.exact_force),
        (row.lift_off, other.lift_off, row.exact_lift_off),
    )
    found = [
        abs(one - two) / exact
        for one, two, exact in figures
        if one is not None and two is not None and exact and math.isfinite(one + two + exact)
    ]
    return max(found, default=0.0)


def of_each_form(rows: Sequence[BenefitRow]) -> tuple[str, ...]:
    """What is enough of each form, of `rows` of one speed, and why; forms without values are left
    out.
    """
    each = [enough([row for row in rows if row.form == form]) for form in FORMS]
    return tuple(words(found) for found in each if found is not None) or (words(None),)


def words(found: Enough | None) -> str:
    """What is enough, and why."""
    if found is None:
        return "the motion on the written contour is not known for any of these tolerances"
    row = found.row
    parts = [f"{row.form} within {row.tolerance:g} mm"]
    if row.ripple is not None:
        parts.append(f"the acceleration is off by up to {100.0 * row.ripple:.3g} % of its peak")
    if row.force is not None:
        parts.append(f"the contact force by up to {row.force:.3g} N")
    if found.last:
        return f"{', '.join(parts)}; it still improves, and no tighter tolerance was tried"
    gain = f"{100.0 * found.gain:.2g} %"
    return f"{', '.join(parts)}; tighter ones change none of its benefits by more than {gain}"
