"""Of what takes long some cases run: evenly spaced, at least one, and of all others each."""

from __future__ import annotations

import itertools

from tests.thinned import EXPENSIVE, MOST, function_of, kept

CASES = [f"a.py::test_many[{number}]" for number in range(12)]


def test_what_is_cheap_runs_whole() -> None:
    assert kept([*CASES, "a.py::test_one"], {"a.py::test_other": 100.0}) == [True] * 13


def test_one_of_so_many_runs_that_they_take_about_the_most() -> None:
    runs = kept(CASES, {"a.py::test_many": 4 * MOST})
    found = [number for number, each in enumerate(runs) if each]
    assert len(found) == 3
    assert {after - before for before, after in itertools.pairwise(found)} == {4}


def test_one_runs_at_least() -> None:
    assert sum(kept(CASES, {"a.py::test_many": 1000 * MOST})) == 1
    assert kept(CASES[:1], {"a.py::test_many": 1000 * MOST}) == [True]


def test_the_expensive_ones_have_several_cases_and_are_long() -> None:
    assert EXPENSIVE
    assert all(name == function_of(name) for name in EXPENSIVE)
    assert max(EXPENSIVE.values()) > MOST
