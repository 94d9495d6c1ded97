"""Trimmed discs and written contours move their followers, and load them, as in the record."""

from __future__ import annotations

from tests.effects.recorded import designs, differences


def test_trimmed_discs_and_written_contours_have_the_results_of_the_record() -> None:
    assert not [each for name, made in designs("states") for each in differences(name, made)]
