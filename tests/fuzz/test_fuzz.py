"""Random cases; `python -m tests.fuzz` draws others in every run."""

from __future__ import annotations

from typing import Final

import pytest

from tests.fuzz.runner import fuzz

SECONDS: Final = 15.0
"""CPU of the cases."""

SEED: Final = 2026


def test_random_cases(capsys: pytest.CaptureFixture[str]) -> None:
    report = fuzz(SEED, seconds=SECONDS, by_cpu=True, minimise=20.0)
    with capsys.disabled():
        print(f"\n{report.text}")  # noqa: T201 - so that a run can be repeated
    assert not report.found, "\n\n".join((*report.messages, report.text))
