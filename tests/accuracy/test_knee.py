"""The knee: where machining time, decimals, ripple, benefit or cost end what accuracy gains."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camgeo.studies.accuracy.benefit import SLACK, BenefitRow, End, advice, find_knee
from camgeo.studies.accuracy.contours import ContourRow
from tests.accuracy.rows import file, missing, row
from tests.findings import known


def milled(*times: tuple[float, float, int]) -> list[ContourRow]:
    """Rows of (tolerance, seconds of a round, decimals)."""
    return [
        row("arcs", tolerance, 10 + number, seconds=seconds, decimals=decimals)
        for number, (tolerance, seconds, decimals) in enumerate(times)
    ]


def costing(*costs: tuple[int, int, float]) -> list[ContourRow]:
    """Rows of (pieces, bytes, seconds), a decade apart."""
    return [
        replace(
            row("spline", 10.0**-number, pieces),
            drawing=replace(file(size), write_seconds=0.75 * seconds, read_seconds=0.25 * seconds),
        )
        for number, (pieces, size, seconds) in enumerate(costs, start=1)
    ]


QUICKER = milled((1e-2, 50, 4), (1e-3, 50.1, 4), (1e-4, 53, 4), (1e-5, 60, 4))

COARSER = milled((1e-2, 50, 4), (1e-3, 50, 4), (1e-4, 50, 5), (1e-5, 50, 6))

SPLINES = [row("spline", 1e-2, 5, decimals=4), row("spline", 1e-3, 6, decimals=5)]

CHEAP = costing((10, 10, 1.0), (11, 10, 1.0), (12, 10, 1.0))


@pytest.mark.parametrize(
    ("rows", "place", "end", "quick", "said"),
    [
        (QUICKER, 1, "time", 1e-3, "more slowly"),
        (COARSER, 1, "decimals", 1e-5, "arcs (fewest) within 0.001 mm: 11 pieces"),
        (COARSER, 1, "decimals", 1e-5, "no slower down to 1e-05 mm, but need more decimals than 4"),
        (SPLINES, 0, "decimals", None, "tighter programs need more decimals than 4"),
        (CHEAP, 2, "range", None, "that is the end of what was tried, not a knee"),
        ([row("arcs", 1e-2, 5)], 0, "range", None, ""),
        ([row("arcs", 1e-2, 5), missing("arcs", 1e-3)], 0, "reach", None, ""),
        (
            [row("arcs", 1e-2, 5), missing("arcs", 1e-3), row("arcs", 1e-4, 99, size=999_999)],
            0,
            "cost",
            None,
            "",
        ),
    ],
)
def test_where_it_is_and_why_it_is_not_tighter(
    rows: list[ContourRow], place: int, end: End, quick: float | None, said: str
) -> None:
    """A spline is milled by no round, but has decimals."""
    knee = known(find_knee(rows))
    assert knee.row is rows[place]
    assert (knee.end, knee.quick) == (end, quick)
    assert said in advice(knee)


@pytest.mark.parametrize("over", [-1e-9, 1e-9])
def test_five_per_cent_are_the_border(over: float) -> None:
    knee = known(find_knee(milled((1e-2, 50, 4), (1e-3, 50 * (SLACK + over), 4))))
    assert knee.row.tolerance == (1e-2 if over > 0.0 else 1e-3)


def test_a_ripple_that_falls_no_more_is_an_end_and_cost_is_none_then() -> None:
    ripples = {1e-2: 0.2, 1e-3: 0.1, 1e-4: 0.098, 1e-5: 0.099}
    rows = [
        row("arcs", tolerance, 10**number, seconds=50.0, decimals=4, ripple=ripple)
        for number, (tolerance, ripple) in enumerate(ripples.items(), start=1)
    ]
    knee = known(find_knee(rows))
    assert (knee.row.tolerance, knee.end) == (1e-3, "ripple")
    assert knee.bought == pytest.approx(0.1)
    assert "ripple 10 %" in advice(knee)
    assert knee.step_sentence.endswith("machining the same, and buys 10 % of the acceleration")


def benefits(*off: float) -> list[BenefitRow]:
    """Of a motion whose acceleration has the peak 1, a decade apart."""
    return [BenefitRow("spline", 10.0**-k, 1.0, each, 1.0) for k, each in enumerate(off, start=1)]


def test_where_the_benefit_is_known_it_decides_and_not_the_cost() -> None:
    rows = costing((10, 10, 1.0), (100, 100, 10.0), (1000, 1000, 100.0), (10**4, 10**4, 1e3))
    knee = known(find_knee(rows, benefits(0.8, 0.4, 0.1, 0.06)))
    assert (knee.row, knee.end, knee.step) == (rows[2], "benefit", (rows[1], rows[2]))
    assert knee.bought == pytest.approx(0.3)
    assert advice(knee).endswith("at most 5 %")
    cheap = known(
        find_knee(rows, [replace(each, acceleration=None) for each in benefits(0.8, 0.4)])
    )
    assert (cheap.row, cheap.end) == (rows[0], "cost")


@pytest.mark.parametrize(
    ("last", "tolerance"),
    [
        ((2_249, 2_249, 2.249), 1e-2),
        ((2_251, 2_251, 2.251), 1e-1),
        # Seconds of two runs that differ by a third change the mean by a tenth.
        ((2_000, 2_000, 2.8), 1e-2),
        ((2_000, 2_000, 2.9), 1e-1),
    ],
)
def test_two_steps_of_a_half_more_are_the_border_of_what_all_costs_together(
    last: tuple[int, int, float], tolerance: float
) -> None:
    """1.5^2 = 2.25, of the geometric mean: 2000^2 * 2.8475 is 2250^2 * 2.25."""
    knee = known(find_knee(costing((1_000, 1_000, 1.0), last, (10**6, 10**6, 1e3))))
    assert knee.row.tolerance == pytest.approx(tolerance)
    assert knee.end == "cost"
    assert advice(knee).endswith("tighter ones cost more than 2.25 times as much as the cheapest")


def test_seconds_of_a_machine_count_only_if_asked_for() -> None:
    rows = costing((10, 10, 1.0), (15, 15, 50.0), (100, 100, 100.0))
    for timed, place in ((True, 0), (False, 1)):
        assert known(find_knee(rows, timed=timed)).row is rows[place]


def test_a_step_in_words() -> None:
    """Of the last one up to the knee, or of the first one beyond it."""
    rows = costing((10, 10_000, 0.06), (20, 19_400, 0.0724), (200, 10**6, 9.0))
    knee = known(find_knee(rows))
    assert knee.step_sentence == "from 0.1 mm to 0.01 mm costs 10 pieces, 12 ms and 9.4 kB"
    first = known(find_knee([rows[0], rows[2]]))
    assert first.step_sentence == "from 0.1 mm to 0.001 mm costs 190 pieces, 8.9 s and 990 kB"
    slower = known(find_knee(milled((1e-2, 50, 4), (1e-3, 70, 4))))
    assert slower.step_sentence == (
        "from 0.01 mm to 0.001 mm costs 1 piece, no time and 0 kB, machining 20.0 s longer"
    )
    assert known(find_knee(rows[:1])).step_sentence == ""


def test_nothing_that_can_be_reached() -> None:
    assert find_knee([missing("arcs", 1e-3)]) is None
    assert find_knee([]) is None
    assert advice(None) == "none of these tolerances can be reached"
