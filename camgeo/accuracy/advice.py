"""One sentence: which contour at which tolerance, and what ends beyond."""

from __future__ import annotations

from typing import Final

from camgeo.accuracy.knee import Knee
from camgeo.accuracy.rows import ContourRow, Form

NAMES: Final[dict[Form, str]] = {
    "polyline": "straight pieces",
    "arcs": "arcs",
    "spline": "a spline",
}


def advice(knee: Knee | None) -> str:
    """The sentence for a knee; one that says so for None."""
    if knee is None:
        return "none of these tolerances can be reached"
    row = knee.row
    head = f"{NAMES[row.form]} ({row.effort}) within {row.tolerance:g} mm"
    told = [f"{_pieces(row):,} pieces"]
    if row.drawing is not None:
        told.append(f"drawing of {row.drawing.size:,} bytes")
    if knee.quick is not None:
        told.append(f"milled round in {row.round_seconds:.1f} s")
    if row.ripple is not None:
        told.append(f"ripple {100.0 * row.ripple:.2g} %")
    return f"{head}: {', '.join(told)}; {_beyond(knee)}"


def _beyond(knee: Knee) -> str:
    """What a tighter tolerance costs or cannot have."""
    if knee.end == "range":
        return "no tighter tolerance was looked at"
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


def _pieces(row: ContourRow) -> int:
    assert row.count is not None  # a knee lies where there is a contour
    return row.count.pieces
