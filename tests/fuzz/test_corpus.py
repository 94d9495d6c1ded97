"""Cases that once failed, and do no more; those that still do are strictly expected to.

A case that has failed in any run lies in `corpus/open`, with the revision and the cause in its
reason. It refuses no other change: its test fails only when the case passes, and it is then moved
up. Cases that took too much time or memory are called in one form, as `both` in their file says:
to print what was found as JSON takes little of either. The long form calls them in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pytest

from tests.fuzz import runner
from tests.fuzz.case import CORPUS, OPEN, SLOW, Case, restore, store
from tests.fuzz.invariants import Failure, Outcome
from tests.fuzz.runner import SEPARATOR, fuzz, kept, known_failures
from tests.fuzz.worker import Worker
from tests.long_form import LONG, examples
from tests.thinned import share

MOST_OPEN: Final = 10
"""Cases that may wait for a correction."""


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    worker = Worker()
    yield worker
    worker.close()


def failing(path: Path) -> Any:
    """A case that is expected to fail, and no longer open if it does not."""
    reason = f"{restore(path).source}; where it passes, move it up"
    mark = pytest.mark.xfail(strict=True, raises=AssertionError, reason=reason)
    return pytest.param(path, marks=mark, id=f"{path.parent.name}-{path.stem}")


def failures(path: Path, worker: Worker) -> list[Failure]:
    case = restore(path)
    return worker.run(replace(case, both=case.both or LONG)).failures


def test_cases_of_the_corpus_pass(worker: Worker) -> None:
    found = {path.stem: failures(path, worker) for path in share(kept(CORPUS), 3)}
    assert not any(found.values())
    assert found


@pytest.mark.long  # a second and more each; what was slow once, and is less so now
@pytest.mark.parametrize("path", kept(SLOW), ids=lambda path: path.stem)
def test_slow_case_of_the_corpus(path: Path, worker: Worker) -> None:
    assert failures(path, worker) == []


@pytest.mark.parametrize("path", [*map(failing, kept(OPEN))])
def test_open_case_of_the_corpus(path: Path, worker: Worker) -> None:
    assert failures(path, worker) == []


def test_few_cases_are_open_and_each_has_revision_and_cause() -> None:
    assert len(kept(OPEN)) <= MOST_OPEN
    for path in kept(OPEN):
        _, revision, cause = restore(path).source.split(SEPARATOR)
        assert revision.startswith("revision ")
        assert cause


class Failing(Worker):
    """Runs nothing: all cases fail for the same cause."""

    def draw(self, seed: int, number: int, kind: str | None) -> tuple[str, Case, Outcome]:
        case = Case({"a": b"1"}, (("check", "a"),))
        return "files", case, self.run(case)

    def run(self, case: Case) -> Outcome:
        return Outcome([Failure("exit code 3 in check", ("check", "a"), "told")], done=True)


def test_what_fails_is_kept_as_open_and_found_once_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "Worker", Failing)
    monkeypatch.setattr(runner, "OPEN", tmp_path)
    first = fuzz(1, count=3, keep=tmp_path)
    assert first.found == {"exit code 3 in check": [0, 1, 2]}
    (path,) = kept(tmp_path)
    what, revision, cause = restore(path).source.split(SEPARATOR)
    assert what == "exit code 3 in check"
    assert revision.startswith("revision ")
    assert cause.endswith("python -m tests.fuzz --seed 1 --case 0")
    assert restore(path).files == {}  # made smaller
    assert known_failures() == {"exit code 3 in check"}
    assert fuzz(1, count=3, keep=tmp_path).found == {}


def test_an_open_case_that_passes_refuses_the_run(tmp_path: Path) -> None:
    case = Case({}, (("laws",),), SEPARATOR.join(("exit code 3 in laws", "revision 1", "a limit")))
    (mark,) = failing(store(case, tmp_path / "case")).marks
    assert mark.name == "xfail"
    assert mark.kwargs["strict"]
    assert "a limit" in mark.kwargs["reason"]


# -- fuzz ------------------------------------------------------------------------------------------
# Random cases, the same in every run; `python -m tests.fuzz --seed fresh` draws others.


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
