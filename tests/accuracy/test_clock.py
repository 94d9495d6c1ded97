"""The clock: CPU time, the medians of several runs, and how far these differ."""

from __future__ import annotations

import time
from functools import partial

import pytest

from camgeo.studies.accuracy.contours import (
    ALIKE,
    LONG,
    MOST_RUNS,
    RUNS,
    SHORT,
    SHORT_RUNS,
    Clock,
    Timing,
    repeated,
)


def measured(
    durations: list[float], monkeypatch: pytest.MonkeyPatch, most: int = MOST_RUNS
) -> tuple[int, Timing]:
    """Runs of two steps that take a third and two thirds of these seconds; how many there were."""
    now, done = [0.0], [0]
    monkeypatch.setattr(time, "process_time", lambda: now[0])

    def spend(share: float) -> None:
        now[0] += share * durations[done[0] - 1]

    def run(clock: Clock) -> int:
        done[0] += 1
        now[0] += 100.0  # outside of all steps
        clock.step("one", lambda: spend(1.0 / 3.0))
        clock.step("other", lambda: spend(2.0 / 3.0))
        return done[0]

    return repeated(run, most)


@pytest.mark.parametrize(
    ("durations", "runs", "median", "spread"),
    [
        ([1.1 * LONG], 1, 1.1 * LONG, 1.0),
        ([0.6 * LONG, 0.5 * LONG], 2, 0.55 * LONG, 1.15 / 1.05),
        ([0.9 * SHORT] * RUNS, RUNS, 0.9 * SHORT, 1.0),
        ([0.9 * SHORT, 0.3 * SHORT, 0.5 * SHORT], RUNS, 0.4 * SHORT, 0.45 / 0.35),
        ([0.003, *[0.001] * 4], SHORT_RUNS, 0.001, 1.0),
        ([0.003, 0.001, 0.002, 0.001, 0.002, *[0.002] * 10], 9, 0.002, None),
        ([0.001, 0.002] * MOST_RUNS, MOST_RUNS, 0.0015, 2.0),
    ],
)
def test_the_first_run_is_for_the_caches_and_the_others_have_a_median(
    durations: list[float],
    runs: int,
    median: float,
    spread: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is long is not run again, what is short until the runs are alike."""
    count, found = measured(durations, monkeypatch)
    assert count == runs
    assert found.seconds == pytest.approx({"one": median / 3.0, "other": 2.0 * median / 3.0})
    if spread is None:
        assert found.spread <= ALIKE
    else:
        assert found.spread == pytest.approx(spread)


def test_once_is_once(monkeypatch: pytest.MonkeyPatch) -> None:
    assert measured([0.001] * 9, monkeypatch, 1)[0] == 1


def test_steps_of_one_name_are_one(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = iter((1.0, 1.5, 2.0, 4.0))
    monkeypatch.setattr(time, "process_time", lambda: next(ticks))
    clock = Clock()
    assert [clock.step("proof", partial(abs, each)) for each in (7, -8)] == [7, 8]
    assert clock.seconds == {"proof": 2.5}
