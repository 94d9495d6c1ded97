"""Jobs of a session: their heads are read without the rest, and what is outdated is given up."""

from __future__ import annotations

import asyncio
import json
import threading
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing.children import Job, Refused, Result
from camgeo.app.designing.desk import Desk
from camgeo_export.designer import session
from camgeo_export.designer.session import Jobs, head_of
from tests.designer.served import Clock
from tests.waiting import happened

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=6,
)


SEPARATORS = st.sampled_from([(",", ":"), (" , ", " : ")])


@given(st.dictionaries(st.text(max_size=4), VALUES), st.text(max_size=4), SEPARATORS)
def test_the_head_is_what_stands_before(
    table: dict[str, Any], last: str, separators: tuple[str, str]
) -> None:
    text = json.dumps(table, separators=separators).encode()
    keys = [*table]
    expected = keys[: keys.index(last) + 1] if last in table else keys
    assert head_of(text, (last,)) == {key: table[key] for key in expected}


def test_what_follows_the_head_is_not_read() -> None:
    assert head_of(b'{"faults": [], "text": "a", "label": "b", nonsense', ("label",)) == {
        "faults": [], "text": "a", "label": "b",
    }  # fmt: skip


@pytest.mark.parametrize("other", [False, True])
def test_a_job_that_takes_too_long_is_given_up_for_a_newer_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, other: bool
) -> None:
    """Unless the process does another kind of job as well, which might be ended in its place."""
    ended = threading.Event()
    begun = {kind: threading.Event() for kind in ("findings", "solid")}
    cancelled: list[str] = []
    clock = Clock()
    monkeypatch.setattr(session, "time", clock)

    def compute(job: Job, _: float) -> Result:
        begun[job.kind].set()
        happened("the end of the job", ended)
        if cancelled:
            raise Refused("was cancelled")
        return Result(b"{}")

    def cancel(kind: str) -> None:
        cancelled.append(kind)
        ended.set()

    async def ask() -> Result:
        jobs = Jobs(Desk(tmp_path, tmp_path / "states"), compute, cancel)
        asked = asyncio.create_task(jobs.do("findings"))
        more = [asyncio.create_task(jobs.do("solid"))] if other else []
        for kind in ("findings", *["solid"] * other):
            await asyncio.to_thread(happened, kind, begun[kind])
        clock.now += 5.0
        jobs.give_up("findings", 5.0)
        assert cancelled == []
        clock.now += 0.5
        jobs.give_up("findings", 5.0, unless="solid")
        if other:
            ended.set()
            await asyncio.gather(*more)
        try:
            return await asked
        finally:
            jobs.close()

    if other:
        assert asyncio.run(ask()).data == {}
    else:
        with pytest.raises(Refused):
            asyncio.run(ask())
    assert cancelled == ([] if other else ["findings"])
