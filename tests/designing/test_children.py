"""Processes that compute for the designer: too slow, too large, dead, or orphaned."""

from __future__ import annotations

import gc
import io
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from camgeo.app.designing import children as frames
from camgeo.app.designing.children import QUICK, BrokenFrame, Children, Job, JobError, Refused
from camgeo.scene.toml import template
from tests.long_form import examples
from tests.waiting import PATIENCE, alive, joined, until

ROOT = Path(__file__).parents[2]

BOMBS = "tests.designing.bombs"

KILLS = examples(4, long=200)

PROC = Path("/proc/self/fd")


@pytest.fixture(scope="module")
def children() -> Iterator[Children]:
    with Children(memory=200_000_000, work=BOMBS) as found:
        yield found


def served(children: Children) -> int:
    """The process that serves the next job."""
    found = children.submit(Job("fine", "ü"), PATIENCE)
    assert found.data["text"] == "ü"
    process: int = found.data["process"]
    return process


def test_a_scene_is_painted_by_a_process() -> None:
    with Children() as found:
        result = found.submit(Job("curves", template("translating-roller")), PATIENCE)
        assert result.data["faults"] == []
        assert result.text.startswith(b'{"faults":[]')
        with pytest.raises(Refused, match=r"^nonsense: there is no job 'nonsense'"):
            found.submit(Job("nonsense"), PATIENCE)
        assert found.submit(Job("curves", "="), PATIENCE).data["faults"]


@pytest.mark.parametrize(
    ("kind", "seconds", "told"),
    [
        ("endless", 0.05, r"^endless: took longer than 0\.05 s$"),
        ("greedy", PATIENCE, r"^greedy: took more than 0\.2 GB of memory$"),
        ("gone", PATIENCE, r"^gone: ended the process that computed it$"),
    ],
)
def test_a_job_that_ends_its_process_is_refused_alone(
    children: Children, kind: str, seconds: float, told: str
) -> None:
    if kind == "greedy" and not Path("/proc/self/statm").exists():
        pytest.skip("memory is limited where /proc tells how much is in use")
    before = served(children)
    with pytest.raises(Refused, match=told):
        children.submit(Job(kind), seconds)
    assert served(children) != before


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("broken", r"^broken: met an error in camgeo itself: IndexError: "),
        ("deep", r"^deep: is nested too deeply$"),
        ("infinite", r"^infinite: met an error in camgeo itself: ValueError: "),
    ],
)
def test_a_job_that_fails_leaves_its_process(children: Children, kind: str, told: str) -> None:
    before = served(children)
    with pytest.raises(Refused, match=told):
        children.submit(Job(kind), PATIENCE)
    assert served(children) == before


def test_a_job_that_is_too_large_is_not_sent(children: Children) -> None:
    before = served(children)
    with pytest.raises(JobError, match="too large"):
        children.submit(Job("fine", "x" * 17_000_000), PATIENCE)
    assert served(children) == before


def test_lanes_do_not_wait_for_each_other() -> None:
    """A job of kind "build" is one of this module's too, and has a process of its own."""
    with Children(work=BOMBS) as found:
        served(found)
        errors: list[str] = []

        def build() -> None:
            try:
                found.submit(Job("build", arguments={"as": "endless"}), PATIENCE)
            except Refused as error:
                errors.append(str(error))

        thread = threading.Thread(target=build)
        thread.start()
        served(found)

        def cancelled() -> bool:
            found.cancel("build")
            return not thread.is_alive()

        until("the end of the job", cancelled)
        assert errors == ["build: was cancelled"]


def test_closing_refuses_what_is_being_done() -> None:
    found = Children(work=BOMBS)
    served(found)
    errors: list[str] = []

    def ask() -> None:
        try:
            found.submit(Job("endless"), PATIENCE)
        except Refused as error:
            errors.append(str(error))

    thread = threading.Thread(target=ask)
    thread.start()
    until("the job", found._turns[QUICK].locked)
    found.close()
    joined(thread)
    assert len(errors) == 1
    with pytest.raises(Refused, match="was cancelled"):
        found.submit(Job("fine"), PATIENCE)


def offspring() -> set[str]:
    """Processes that this one has started and that are not done with, ended ones among them."""
    tasks = Path("/proc/self/task").glob("*/children")
    found: set[str] = set()
    for each in tasks:
        with suppress(OSError):  # of a thread that has ended meanwhile
            found.update(each.read_text("ascii").split())
    return found


@pytest.mark.skipif(not PROC.exists(), reason="open files are counted where /proc lists them")
def test_kills_leave_nothing_behind() -> None:
    gc.collect()  # what other tests have left open
    files, processes = len(list(PROC.iterdir())), offspring()
    with Children(work=BOMBS) as found:
        served(found)
        between = len(list(PROC.iterdir()))
        for _ in range(KILLS):
            with pytest.raises(Refused):
                found.submit(Job("endless"), 0.001)
        served(found)
        assert len(list(PROC.iterdir())) == between
        assert len(offspring() - processes) == 2  # the one that serves, and the spare
    assert len(list(PROC.iterdir())) == files
    assert offspring() <= processes


PARENT = """
import os, threading
from camgeo.app.designing.children import Children
from camgeo.app.designing.children import Job
from tests.waiting import PATIENCE, alive
found = Children(work="tests.designing.bombs")
idle = found.submit(Job("fine"), PATIENCE).data["process"]
busy = found.submit(Job("build"), PATIENCE).data["process"]
endless = Job("build", arguments={"as": "endless"})
threading.Thread(target=found.submit, args=(endless, PATIENCE)).start()
print(idle, busy, found._spare.process.pid, flush=True)
"""


@pytest.mark.skipif(not PROC.exists(), reason="processes are watched where /proc lists them")
def test_children_end_with_a_parent_that_is_killed() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PARENT], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout is not None
        found = [int(each) for each in parent.stdout.readline().split()]
        assert len(found) == 3
        assert all(map(alive, found))
        os.kill(parent.pid, signal.SIGKILL)
    until("the end of the processes", lambda: not any(map(alive, found)))


@pytest.mark.parametrize(
    "data",
    [b"", b"J", frames.HEAD.pack(b"J", 5) + b"1234", frames.HEAD.pack(b"x", 0),
     frames.HEAD.pack(b"J", 11) + b"x" * 11, frames.HEAD.pack(b"J", 2**63)],
)  # fmt: skip
def test_what_is_no_frame_is_broken(data: bytes) -> None:
    with pytest.raises(BrokenFrame):
        frames.receive(io.BytesIO(data), 10)


def test_a_frame_comes_out_as_it_went_in() -> None:
    stream = io.BytesIO()
    frames.send(stream, b"R", b"why")
    frames.send(stream, b"J")
    stream.seek(0)
    assert frames.receive(stream, 10) == (b"R", b"why")
    assert frames.receive(stream, 10) == (b"J", b"")
