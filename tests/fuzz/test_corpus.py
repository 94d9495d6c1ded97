"""Cases that once failed, and do no more.

Those that took too much time or memory are called in one form, as `both` in their file says: to
print what was found as JSON takes little of either. The long form calls them in both, and all of
them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fuzz.case import CORPUS, OPEN, restore
from tests.fuzz.worker import Worker
from tests.long_form import LONG, some


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    worker = Worker()
    yield worker
    worker.close()


@pytest.mark.parametrize("path", some(sorted(CORPUS.iterdir()), of=2), ids=lambda path: path.stem)
def test_case_of_the_corpus(path: Path, worker: Worker) -> None:
    case = restore(path)
    case = replace(case, both=case.both or LONG)
    failures = worker.run(case).failures
    if case.source.startswith(OPEN) and failures:
        pytest.xfail(case.source)
    assert failures == []
