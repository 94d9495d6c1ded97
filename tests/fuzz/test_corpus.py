"""Cases that once failed, and do no more."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fuzz.case import CORPUS, OPEN, restore
from tests.fuzz.worker import Worker


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    worker = Worker()
    yield worker
    worker.close()


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.stem)
def test_case_of_the_corpus(path: Path, worker: Worker) -> None:
    case = restore(path)
    failures = worker.run(case).failures
    if case.source.startswith(OPEN) and failures:
        pytest.xfail(case.source)
    assert failures == []
