"""Random cases, the same in every run; `python -m tests.fuzz --seed fresh` draws others."""

from __future__ import annotations

from typing import Final

import pytest

from tests.fuzz.runner import fuzz
from tests.long_form import examples

SEED: Final = 2026

FIRST: Final = examples(218, long=150)
"""Number of the first case: from here all kinds come soon, and one builds files that verify."""

CASES: Final = examples(10, long=31)


def test_random_cases(capsys: pytest.CaptureFixture[str]) -> None:
    report = fuzz(SEED, first=FIRST, count=CASES, minimise=20)
    with capsys.disabled():
        print(f"\n{report.text}")  # noqa: T201 - so that a run can be repeated
    assert not report.found, "\n\n".join((*report.messages, report.text))
    assert report.cases.total() == CASES
    assert min(report.cases.values()) >= 2
    assert report.verified >= 1
