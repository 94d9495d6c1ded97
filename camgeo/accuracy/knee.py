"""The knee: among what was measured, the tolerance beyond which more cost gains nothing.

Each decade of accuracy multiplies the pieces by 10^(1/k), k = 2, 3, 4 for chords, arcs and cubics;
a power law has no knee. The benefit of the pieces has one: the knee is where the first of their
benefits ends.

Milling (the scene has a program, its machine an acceleration). Of all contours that a controller
accepts, lines and arcs, the fastest round is the cost of a coarse contour. The knee is the
tightest tolerance

- at which a contour is milled in at most 5 % more time than that: beyond it, blocks become too
  short for the feed, which costs minutes of machining;
- and whose program is printed with no more decimals than the loosest one: a program has at least
  the controller's number of decimals, and beyond that the printed numbers set the limit, not the
  contour;
- and up to which the ripple of the replay, if requested, falls by at least 5 %: beyond it the
  follower runs no smoother.

Files only. A drawing has a constant part, header and layers, and a part that grows by the power
above. While the growing part is the smaller one, accuracy adds little; beyond that, each decade
multiplies the whole file. The knee of a form is the tightest tolerance whose drawing is at most
twice its smallest one, that of the design the tightest of the three.

Of several contours at the knee the one with the fewest pieces is recommended, among those with the
least ripple if it was requested.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from camgeo.accuracy.rows import FORMS, ContourRow
from camgeo.contour.contour import Form
from camgeo.wording import counted

SLACK: Final = 1.05
"""Machining times and ripples up to this factor of the best count as the best: feed override and
rounding of a plan change them more."""

DOUBLE: Final = 2.0
"""Largest drawing relative to the smallest: the growing part is no larger than the constant one."""

NAMES: Final[dict[Form, str]] = {
    "polyline": "straight pieces",
    "arcs": "arcs",
    "spline": "a spline",
}

End = Literal["time", "decimals", "ripple", "size", "reach", "range"]


@dataclass(frozen=True, slots=True)
class Knee:
    """The recommendation, and which benefit ends beyond it.

    Attributes
    ----------
    row : the recommended contour.
    end : what a tighter tolerance loses: "time", "decimals", "ripple" or, without milling, "size";
        "reach" if it cannot be reached, "range" if none was measured.
    quick : with milling the tightest tolerance [mm] that is milled in at most 5 % more than the
        least time; None without.
    next : the same contour one tolerance tighter, if there is one.
    """

    row: ContourRow
    end: End
    quick: float | None
    next: ContourRow | None


def knee_of(rows: Sequence[ContourRow]) -> Knee | None:
    """The knee of the measured rows; None if nothing could be reached."""
    milled = [row for row in _valid(rows) if row.round_seconds is not None]
    if any(row.program is not None for row in milled):
        return _milling(rows, milled)
    return drawing_knee(rows)


def drawing_knee(rows: Sequence[ContourRow]) -> Knee | None:
    """The knee of the drawing, whether it is milled or not; None if nothing could be reached."""
    return _files(rows, _valid(rows))


def _valid(rows: Sequence[ContourRow]) -> list[ContourRow]:
    return [row for row in rows if row.count is not None and row.drawing is not None]


def advice(knee: Knee | None) -> str:
    """The sentence for a knee; for None, that none can be reached."""
    if knee is None:
        return "none of these tolerances can be reached"
    row = knee.row
    head = f"{NAMES[row.form]} ({row.effort}) within {row.tolerance:g} mm"
    costs = [counted(_pieces(row), "piece")]
    if row.drawing is not None:
        costs.append(f"drawing of {counted(row.drawing.size, 'byte')}")
    if knee.quick is not None:
        costs.append(f"milled round in {row.round_seconds:.1f} s")
    if row.ripple is not None:
        costs.append(f"ripple {100.0 * row.ripple:.2g} %")
    return f"{head}: {', '.join(costs)}; {_beyond(knee)}"


def _beyond(knee: Knee) -> str:
    """What a tighter tolerance costs, or why there is none."""
    if knee.end == "range":
        return "no tighter tolerance was tried"
    if knee.end == "reach":
        return "tighter tolerances cannot be reached"
    if knee.end == "time":
        return "tighter contours are milled more slowly, their blocks are too short for the feed"
    if knee.end == "ripple":
        return "tighter contours run no smoother"
    if knee.end == "decimals":
        program = knee.row.program
        decimals = "" if program is None else f" than {program.facts['decimals']}"
        return (
            f"tighter programs are no slower down to {knee.quick:g} mm, but need more decimals"
            f"{decimals}, which the machine is not known to resolve"
        )
    return f"up to there a drawing is at most twice its smallest size{_growth(knee)}"


def _growth(knee: Knee) -> str:
    after = knee.next
    if after is None or after.drawing is None or knee.row.drawing is None:
        return ""
    factor = after.drawing.size / knee.row.drawing.size
    return f", {after.tolerance:g} mm makes it {factor:.1f} times as large"


def _milling(measured: Sequence[ContourRow], rows: Sequence[ContourRow]) -> Knee:
    quickest = min(_seconds(row) for row in rows)
    allowed = [row for row in rows if _seconds(row) <= SLACK * quickest]
    quick = tightest = min(row.tolerance for row in allowed)
    end = _end(measured, rows, tightest, "time")
    limits: tuple[tuple[float | None, End], ...] = (
        (_decimals(rows), "decimals"),
        (_ripple(rows), "ripple"),
    )
    for limit, name in limits:
        if limit is not None and limit > tightest:
            tightest, end = limit, name
    at_knee = _smoothest([row for row in allowed if row.tolerance == tightest])
    return _knee(rows, at_knee, end, quick)


def _smoothest(rows: Sequence[ContourRow]) -> Sequence[ContourRow]:
    """Those with the least ripple; all of them where it was not requested."""
    ripples = [row.ripple for row in rows if row.ripple is not None]
    if not ripples:
        return rows
    limit = SLACK * min(ripples)
    return [row for row in rows if row.ripple is not None and row.ripple <= limit]


def _files(measured: Sequence[ContourRow], rows: Sequence[ContourRow]) -> Knee | None:
    knees: list[ContourRow] = []
    for form in FORMS:
        own = [row for row in rows if row.form == form]
        if own:
            smallest = min(_size(row) for row in own)
            allowed = [row for row in own if _size(row) <= DOUBLE * smallest]
            tightest = min(row.tolerance for row in allowed)
            knees += [row for row in allowed if row.tolerance == tightest]
    if not knees:
        return None
    tightest = min(row.tolerance for row in knees)
    at_knee = [row for row in knees if row.tolerance == tightest]
    return _knee(rows, at_knee, _end(measured, rows, tightest, "size"), None)


def _end(
    measured: Sequence[ContourRow], rows: Sequence[ContourRow], tightest: float, price: End
) -> End:
    """Why it is not the next tighter tolerance: its cost, if any."""
    forms = {row.form for row in rows}
    tighter = [row.tolerance for row in measured if row.form in forms and row.tolerance < tightest]
    if not tighter:
        return "range"
    return price if any(row.tolerance == max(tighter) for row in rows) else "reach"


def _decimals(rows: Sequence[ContourRow]) -> float | None:
    """Tightest tolerance whose program has no more decimals than the loosest."""
    counts = {row.tolerance: row.program.facts["decimals"] for row in rows if row.program}
    if not counts:
        return None
    least = counts[max(counts)]
    return min(tolerance for tolerance, count in counts.items() if count == least)


def _ripple(rows: Sequence[ContourRow]) -> float | None:
    """Loosest tolerance at which a contour has the least ripple there is."""
    ripples = [(row.ripple, row.tolerance) for row in rows if row.ripple is not None]
    if not ripples:
        return None
    least, _ = min(ripples)
    return max(tolerance for ripple, tolerance in ripples if ripple <= SLACK * least)


def _knee(
    rows: Sequence[ContourRow], at_knee: Sequence[ContourRow], end: End, quick: float | None
) -> Knee:
    best = min(at_knee, key=_pieces)
    tighter = [
        row
        for row in rows
        if (row.form, row.effort) == (best.form, best.effort) and row.tolerance < best.tolerance
    ]
    return Knee(best, end, quick, max(tighter, key=lambda row: row.tolerance, default=None))


def _seconds(row: ContourRow) -> float:
    assert row.round_seconds is not None  # checked before
    return row.round_seconds


def _size(row: ContourRow) -> int:
    assert row.drawing is not None  # checked before
    return row.drawing.size


def _pieces(row: ContourRow) -> int:
    assert row.count is not None  # checked before
    return row.count.pieces
