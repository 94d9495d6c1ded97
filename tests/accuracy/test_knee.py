"""The knee: where machining time, decimals, ripple or size end the benefit of accuracy."""

from __future__ import annotations

import pytest

from camgeo.accuracy.knee import DOUBLE, SLACK, End, advice, knee_of
from camgeo.accuracy.rows import ContourRow
from tests.accuracy.rows import missing, row


def milled(*times: tuple[float, float, float, int]) -> list[ContourRow]:
    """Rows of (tolerance, seconds with chords, seconds with arcs, decimals)."""
    rows = []
    for number, (tolerance, chords, arcs, decimals) in enumerate(times):
        rows.append(row("polyline", tolerance, 40 * 4**number, seconds=chords))
        rows.append(row("arcs", tolerance, 10 * 2**number, seconds=arcs, decimals=decimals))
    return rows


def test_the_tightest_tolerance_that_is_still_milled_quickly() -> None:
    rows = milled((1e-2, 50, 50, 4), (1e-3, 50, 50.1, 4), (1e-4, 80, 53, 4), (1e-5, 99, 60, 4))
    knee = knee_of(rows)
    assert knee is not None
    assert (knee.row.form, knee.row.tolerance, knee.end) == ("arcs", 1e-3, "time")
    assert knee.quick == 1e-3
    assert knee.next is rows[5]
    assert "more slowly" in advice(knee)


@pytest.mark.parametrize("over", [-1e-9, 1e-9])
def test_five_per_cent_are_the_border(over: float) -> None:
    rows = milled((1e-2, 60, 50, 4), (1e-3, 80, 50 * (SLACK + over), 4))
    knee = knee_of(rows)
    assert knee is not None
    assert knee.row.tolerance == (1e-2 if over > 0.0 else 1e-3)


def test_chords_are_enough_where_arcs_are_slower() -> None:
    rows = milled((1e-2, 50, 80, 4), (1e-3, 50, 80, 4))
    knee = knee_of(rows)
    assert knee is not None
    assert knee.row.form == "polyline"
    assert knee.end == "range"
    assert advice(knee).endswith("no tighter tolerance was tried")


def test_more_decimals_than_the_controller_asks_for_buy_nothing() -> None:
    rows = milled((1e-2, 50, 50, 4), (1e-3, 50, 50, 4), (1e-4, 50, 50, 5), (1e-5, 90, 50, 6))
    knee = knee_of(rows)
    assert knee is not None
    assert (knee.row.tolerance, knee.end, knee.quick) == (1e-3, "decimals", 1e-5)
    text = advice(knee)
    assert text.startswith("arcs (fewest) within 0.001 mm: 20 pieces")
    assert "no slower down to 1e-05 mm, but need more decimals than 4" in text


def test_a_ripple_that_falls_no_more_is_an_end() -> None:
    ripples = {1e-2: 0.2, 1e-3: 0.1, 1e-4: 0.098, 1e-5: 0.099}
    rows = [
        row("arcs", tolerance, 10 * number, seconds=50.0, decimals=4, ripple=ripple)
        for number, (tolerance, ripple) in enumerate(ripples.items(), start=1)
    ]
    knee = knee_of(rows)
    assert knee is not None
    assert (knee.row.tolerance, knee.end) == (1e-3, "ripple")
    assert "ripple 10 %" in advice(knee)


def test_chords_of_fewer_pieces_do_not_win_where_they_run_rougher() -> None:
    rows = [
        row("polyline", 1e-3, 10, seconds=50.0, ripple=6.0),
        row("arcs", 1e-3, 20, seconds=50.0, decimals=4, ripple=0.1),
        row("arcs", 1e-3, 30, effort="fast", seconds=50.0, decimals=4, ripple=0.102),
    ]
    knee = knee_of(rows)
    assert knee is not None
    assert knee.row is rows[1]


def test_fewer_pieces_win_at_the_knee() -> None:
    rows = [
        row("arcs", 1e-3, 20, seconds=50.0, decimals=4),
        row("arcs", 1e-3, 30, effort="fast", seconds=50.0, decimals=4),
    ]
    assert (knee := knee_of(rows)) is not None
    assert knee.row is rows[0]
    assert (knee := knee_of(rows[::-1])) is not None
    assert knee.row is rows[0]


def test_without_milling_the_size_of_the_drawing_decides() -> None:
    rows = [
        *(row("polyline", t, 9, size=s) for t, s in ((1e-2, 10_000), (1e-3, 40_000))),
        *(row("arcs", t, 8, size=s) for t, s in ((1e-2, 9_000), (1e-3, 18_000), (1e-4, 30_000))),
        *(row("spline", t, 7, size=s) for t, s in ((1e-2, 9_500), (1e-3, 18_000), (1e-4, 19_001))),
    ]
    knee = knee_of(rows)
    assert knee is not None
    assert DOUBLE * 9_000 == 18_000
    assert (knee.row.form, knee.row.tolerance, knee.end) == ("spline", 1e-3, "size")
    assert knee.quick is None
    assert advice(knee).endswith("0.0001 mm makes it 1.1 times as large")


def test_times_without_a_program_are_no_milling() -> None:
    rows = [row("arcs", 1e-2, 5, size=9, seconds=10.0), row("arcs", 1e-3, 9, size=18, seconds=90.0)]
    knee = knee_of(rows)
    assert knee is not None
    assert knee.row is rows[1]
    assert knee.quick is None


@pytest.mark.parametrize(
    ("rows", "end"),
    [
        ([row("arcs", 1e-2, 5)], "range"),
        ([row("arcs", 1e-2, 5), missing("arcs", 1e-3)], "reach"),
        ([row("arcs", 1e-2, 5), missing("spline", 1e-3)], "range"),
        (
            [row("arcs", 1e-2, 5), missing("spline", 1e-3), row("arcs", 1e-3, 9, size=99_999)],
            "size",
        ),
    ],
)
def test_why_it_is_not_tighter(rows: list[ContourRow], end: End) -> None:
    knee = knee_of(rows)
    assert knee is not None
    assert knee.row is rows[0]
    assert knee.end == end


def test_nothing_that_can_be_reached() -> None:
    assert knee_of([missing("arcs", 1e-3)]) is None
    assert knee_of([]) is None
    assert advice(None) == "none of these tolerances can be reached"
