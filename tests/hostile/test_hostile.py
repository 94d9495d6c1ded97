"""Hostile and damaged files are refused by every reader, quickly, and in little memory.

A child process imports all readers, and each reader then runs in a fork of it. Times are those of
the processor, in units of this machine: it may be slow, and may have other work.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import pytest

from tests.hostile.__main__ import MUTATED
from tests.long_form import examples

ROOT: Final = Path(__file__).parents[2]

SECONDS: Final = examples(6.0, long=18.0)
"""Of computing, four times what is measured; in the long form what takes time to read is longer."""

MEGABYTES: Final = 300.0

EVERY: Final = examples(12, long=1)
"""One of so many inputs is read."""

MUTATIONS: Final = examples(2, long=12)
"""Of each good file; `--mutations 300` of another seed runs more."""

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="the readers are run in forks"),
    pytest.mark.xdist_group("hostile"),  # all share one run
]


@dataclass(frozen=True, slots=True)
class Result:
    """What a reader did with one file, as `tests.hostile.__main__` says."""

    reader: str
    name: str
    reason: str
    error: str
    seconds: float
    megabytes: float


def results(*words: str) -> list[Result]:
    """Of a run of `python -m tests.hostile`."""
    command = [sys.executable, "-m", "tests.hostile", *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [Result(**json.loads(line)) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def read() -> list[Result]:
    """Of all files, read in one run."""
    return results("--every", str(EVERY), "--mutations", str(MUTATIONS), "--seed", "1")


@pytest.fixture(scope="module")
def hostile(read: list[Result]) -> list[Result]:
    return [each for each in read if not each.name.startswith(MUTATED)]


def test_there_are_many_for_every_reader(hostile: list[Result]) -> None:
    counts = Counter(each.reader for each in hostile)
    assert len(counts) == 18
    assert min(counts.values()) >= 20 / EVERY
    assert len({(each.reader, each.name) for each in hostile}) == len(hostile) >= 1000 / EVERY


def test_none_is_taken_or_crashes_a_reader(hostile: list[Result]) -> None:
    assert [each for each in hostile if each.error or not each.reason] == []


def test_none_takes_long_or_much_memory(hostile: list[Result]) -> None:
    assert [each for each in hostile if each.seconds > SECONDS] == []
    assert [each for each in hostile if each.megabytes > MEGABYTES] == []


def test_mutated_files_crash_no_reader(read: list[Result]) -> None:
    found = [each for each in read if each.name.startswith(MUTATED)]
    assert len(found) == 18 * MUTATIONS
    assert [each for each in found if each.error] == []
