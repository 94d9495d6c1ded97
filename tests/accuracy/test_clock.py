"""The clock: the shortest of several runs, or one run if it takes long."""

from __future__ import annotations

import time

import pytest

from camgeo.accuracy.contours import PATIENCE, RUNS, timed


@pytest.mark.parametrize(
    ("durations", "runs", "seconds"),
    [
        ([0.003, 0.001, 0.002, 0.0001], RUNS, 0.001),
        ([1.1 * PATIENCE, 0.01], 1, 1.1 * PATIENCE),
        ([0.6 * PATIENCE, 0.5 * PATIENCE, 0.01], 2, 0.5 * PATIENCE),
    ],
)
def test_the_quickest_run_counts(
    durations: list[float], runs: int, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [0.0]
    done: list[float] = []

    def work() -> int:
        done.append(durations[len(done)])
        now[0] += done[-1]
        return len(done)

    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    result, best = timed(work)
    assert result == len(done) == runs
    assert best == pytest.approx(seconds)
