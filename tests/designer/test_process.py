"""The whole designer as a process: killed in the middle of edits, or ended, it leaves order."""

from __future__ import annotations

import http.client
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import pytest
from websockets import Origin
from websockets.sync.client import connect

from tests.designer.served import Client
from tests.waiting import PATIENCE, alive, ended, until

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals, and /proc, of Linux")

SETZHUB: Final = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"


@dataclass(frozen=True)
class Running:
    """A designer that runs, and a page of it."""

    process: subprocess.Popen[str]
    page: Client
    printed: str

    @property
    def family(self) -> list[int]:
        """The processes that it has started."""
        number = self.process.pid
        children = Path(f"/proc/{number}/task/{number}/children").read_text()
        return [int(each) for each in children.split()]


@contextmanager
def running(folder: Path, *words: str) -> Generator[Running]:
    """A designer, let in by the address that it has printed."""
    states = {"XDG_STATE_HOME": str(folder.parent / "states")}
    with subprocess.Popen(
        [sys.executable, "-m", "camgeo", "design", *words, "--no-browser"],
        cwd=folder, env=os.environ | states, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        try:
            printed = process.stdout.readline() + process.stdout.readline()
            address = re.search(r"http://(127\.0\.0\.1:\d+)/(\S+)", printed)
            assert address is not None
            host, path = address.groups()
            entry = http.client.HTTPConnection(host, timeout=PATIENCE)
            entry.request("GET", f"/{path}")
            cookie = str(entry.getresponse().headers["set-cookie"]).partition(";")[0]
            entry.close()
            with connect(
                f"ws://{host}/ws",
                origin=Origin(f"http://{host}"),
                additional_headers={"Cookie": cookie},
                max_size=None,
                open_timeout=PATIENCE,
                ping_interval=None,
            ) as socket:
                yield Running(process, Client(socket), printed)
        finally:
            process.kill()


def require_ended(numbers: list[int]) -> None:
    """Processes that end by themselves."""
    until("the end of the processes of a designer", lambda: not any(map(alive, numbers)))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    found = tmp_path / "scenes"
    found.mkdir()
    shutil.copy(SETZHUB, found / "cam.toml")
    return found


def test_a_kill_in_the_middle_of_edits_loses_no_file_and_no_edit(folder: Path) -> None:
    before = (folder / "cam.toml").read_bytes()
    with running(folder, "cam.toml") as server:
        page = server.page
        page.say("hello")
        assert page.hear("state")["saved"] is True
        for number, radius in enumerate((8.0, 8.5, 9.0)):
            page.say("change", id=number, edits={"follower.roller_radius": radius})
            text = page.hear("curves", answers=number)["text"]
        family = server.family
        server.process.send_signal(signal.SIGKILL)
        require_ended(family)
    assert (folder / "cam.toml").read_bytes() == before
    assert "roller_radius = 9" in text
    with running(folder, "cam.toml") as server:
        page = server.page
        page.say("hello")
        assert page.hear("state", saved=False)["text"] == text
        assert "unsaved edits of cam.toml have been restored" in page.hear("told")["message"]
        for _ in range(3):
            page.say("undo")
        assert page.hear("state", saved=True)["text"].encode() == before
        page.say("redo")
        page.say("save", id=9)
        page.hear("state", saved=True)
        family = server.family
        server.process.send_signal(signal.SIGINT)
        assert ended(server.process) == 0
        require_ended(family)
        assert server.process.stderr is not None
        told = server.process.stderr.read()
    assert "unsaved edits of cam.toml have been restored" in told
    assert "Traceback" not in told
    assert b"roller_radius = 8" in (folder / "cam.toml").read_bytes()
    assert [*(folder.parent / "states" / "camgeo" / "designer").iterdir()] == []


def test_ctrl_c_while_processes_start_ends_them_silently(folder: Path) -> None:
    """A terminal sends it to all processes that it has started, theirs among them."""
    with running(folder, "cam.toml") as server:
        family = server.family
        os.killpg(server.process.pid, signal.SIGINT)
        assert ended(server.process) == 0
        require_ended(family)
        assert server.process.stderr is not None
        assert server.process.stderr.read() == "\n"  # after the ^C of the terminal


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.long)]
)  # both are caught by one handler, see tests/cli/test_process.py
def test_other_signals_end_it_too_and_leave_nothing_running(folder: Path, number: int) -> None:
    with running(folder) as server:
        page = server.page
        page.say("hello")
        page.say("new", template="translating-roller")
        page.hear("state", undo="new scene, translating-roller")
        family = server.family
        server.process.send_signal(number)
        assert ended(server.process) == 128 + number
        require_ended(family)
        assert server.process.stdout is not None
        assert server.process.stderr is not None
        rest, told = server.process.stdout.read(), server.process.stderr.read()
    assert "unsaved edits of the new scene are kept until it is opened again" in told
    assert server.printed.partition("token=")[2].split()[0] not in rest + told
    assert "Traceback" not in told
