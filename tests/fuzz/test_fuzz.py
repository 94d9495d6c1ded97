"""Random cases, other ones in every run; the seed is printed and repeats them."""

from __future__ import annotations

import secrets

import pytest

from tests.fuzz.runner import fuzz

SECONDS = 15.0
"""CPU of the cases."""


def test_random_cases(capsys: pytest.CaptureFixture[str]) -> None:
    seed = secrets.randbelow(10**9)
    report = fuzz(seed, seconds=SECONDS, by_cpu=True, minimise=20.0)
    with capsys.disabled():
        print(f"\n{report.text}")  # noqa: T201 - so that a run can be repeated
    assert not report.found, "\n\n".join((*report.messages, report.text))
