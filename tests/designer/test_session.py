"""A session: what a page changes, all pages see; the newest wins, and nothing is overwritten."""

from __future__ import annotations

import asyncio
import contextlib
import json
import threading
from collections.abc import Generator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing.children import Job, JobResult, Refused
from camgeo.app.designing.desk import Desk
from camgeo_export.designer import session
from camgeo_export.designer.session import Jobs, NamedFiles, read_head
from tests.designer.served import Client, Clock, Served, computed, served
from tests.waiting import happened, until


@contextlib.contextmanager
def greeted(*given: Any) -> Generator[Client]:
    """A page of a server that has said hello."""
    with served(*given) as server, server.page() as page:
        page.say("hello")
        yield page


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    found = tmp_path / "scenes"
    found.mkdir()
    (found / "cam.toml").write_bytes(b"a = 1\n")
    (found / "other.toml").write_bytes(b"b = 2\n")
    return found


def test_a_page_sees_the_scene_and_what_it_changes(folder: Path) -> None:
    with greeted(folder, "cam.toml") as page:
        state = page.hear("state")
        assert (state["file"], state["text"], state["saved"]) == ("cam.toml", "a = 1\n", True)
        assert state["folder_files"] == ["cam.toml", "other.toml"]
        assert "translating-roller" in state["templates"]
        assert "dxf" in state["formats"]
        assert page.hear("curves")["of"] == "a = 1\n"
        page.say("change", id=5, edits={"a": 2})
        curves = page.hear("curves", answers=5)
        assert (curves["text"], curves["revision"], curves["label"]) == ("a = 2\n", 1, "a = 2")
        state = page.hear("state")
        assert (state["saved"], state["undo"], state["revision"]) == (False, "a = 2", 1)
        assert page.hear("findings", revision=1)["of"] == "a = 2\n"
        page.say("undo")
        state = page.hear("state", revision=2)
        assert (state["text"], state["redo"], state["saved"]) == ("a = 1\n", "a = 2", True)
        assert page.hear("curves", revision=2)["of"] == "a = 1\n"
        page.say("redo")
        page.say("save")
        page.hear("state", saved=True, undo="a = 2")
    assert (folder / "cam.toml").read_bytes() == b"a = 2\n"
    assert list((folder.parent / "states").iterdir()) == []


def test_two_pages_see_the_same(folder: Path) -> None:
    with served(folder, "cam.toml") as server, server.page() as one, server.page() as other:
        for page in (one, other):
            page.say("hello")
            page.hear("curves", revision=0)
        one.say("change", id=1, edits={"a": 2})
        mine, theirs = one.hear("curves", revision=1), other.hear("curves", revision=1)
        assert (mine.pop("answers"), theirs.pop("answers")) == (1, None)
        assert mine == theirs
        assert one.hear("state", revision=1) == other.hear("state", revision=1)
        other.say("pin")
        assert one.hear("pinned")["curves"]["text"] == "a = 2\n"
        with server.page() as third:
            third.say("hello")
            assert third.hear("state")["text"] == "a = 2\n"
            assert third.hear("pinned")["curves"]["text"] == "a = 2\n"


def test_a_drag_is_one_step_and_its_latest_place_wins(folder: Path) -> None:
    going = threading.Event()
    done: list[Any] = []

    def slow(job: Job, seconds: float) -> Mapping[str, Any]:
        if job.kind == "change":
            done.append(job.arguments["edits"]["a"])
            happened("the end of the drag", going)
        return computed(job, seconds)

    with greeted(folder, "cam.toml", slow) as page:
        page.hear("curves", revision=0)
        for value in range(50):
            page.say("change", id=value, edits={"a": value}, gesture="drag")
        page.say("nonsense", id="all heard")
        page.hear("refused", id="all heard")
        going.set()
        assert page.hear("curves", answers=49)["text"] == "a = 49\n"
        assert done[-1] == 49
        assert len(done) <= 2
        page.say("undo")
        assert page.hear("state", redo="a = 49")["text"] == "a = 1\n"


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The time by which a session tells a pause."""
    clock = Clock()
    monkeypatch.setattr(session, "time", clock)
    return clock


def test_what_moves_is_painted_at_once_and_the_rest_when_it_pauses(
    folder: Path, clock: Clock
) -> None:
    asked: list[str] = []

    def moving(job: Job, seconds: float) -> Mapping[str, Any]:
        asked.append(job.kind)
        found = computed(job, seconds)
        if not job.arguments.get("moving"):
            return found
        return {"faults": [], "text": found["text"], "moving": True, "label": found["label"]}

    with served(folder, "cam.toml", moving) as server, server.page() as page:
        page.say("hello")
        page.hear("curves", revision=0)
        clock.now += 2.0 * session.PAUSE
        page.hear("findings", revision=0)
        asked.clear()
        for value in range(5):
            page.say("change", id=value, edits={"a": value}, gesture="drag")
            assert page.hear("moved", answers=value)["text"] == f"a = {value}\n"
        assert asked == ["change"] * 5
        clock.now += 2.0 * session.PAUSE
        heard = [page.hear("curves", "findings", revision=5) for _ in range(2)]
        assert {each["kind"] for each in heard} == {"curves", "findings"}
        assert all(each["of"] == "a = 4\n" and each.get("answers") is None for each in heard)
        assert sorted(asked[5:]) == ["curves", "findings"]
        with server.page() as other:
            other.say("hello")
            assert other.hear("curves", revision=5)["of"] == "a = 4\n"
        page.say("change", id=6, edits={"a": 6}, gesture="another")
        page.say("pin")  # of all, not of what moved
        assert page.hear("pinned", pinned=None)["curves"]["of"] == "a = 6\n"


def test_findings_wait_for_a_pause_and_are_of_the_newest_text(folder: Path, clock: Clock) -> None:
    asked: list[str] = []

    def counted(job: Job, seconds: float) -> Mapping[str, Any]:
        if job.kind == "findings":
            asked.append(job.text)
        return computed(job, seconds)

    with greeted(folder, "cam.toml", counted) as page:
        page.hear("curves", revision=0)
        clock.now += 2.0 * session.PAUSE
        page.hear("findings", revision=0)
        for value in range(10):
            page.say("change", id=value, edits={"a": value})
            page.hear("curves", answers=value)
        assert asked == ["a = 1\n"]
        clock.now += 2.0 * session.PAUSE
        assert page.hear("findings")["revision"] == 10
    assert asked == ["a = 1\n", "a = 9\n"]


def test_a_job_that_is_too_slow_is_told_and_the_text_stays(folder: Path) -> None:
    def never(job: Job, seconds: float) -> Mapping[str, Any]:
        if "slow" in job.text:
            raise Refused(f"{job.kind}: took longer than {seconds:g} s")
        return computed(job, seconds)

    with greeted(folder, "cam.toml", never) as page:
        page.say("text", id=1, text="slow = 1\n")
        curves = page.hear("curves", answers=1)
        assert curves["refused"] == "the picture (curves: took longer than 10 s)"
        assert curves["text"] == "slow = 1\n"
        page.say("change", id=2, edits={"b": 2})  # needs the text alone
        curves = page.hear("curves", answers=2)
        assert curves["refused"] == "the picture (change: took longer than 10 s)"
        assert curves["text"] == "slow = 1\nb = 2\n"
        page.say("change", id=3, handle="roller", to=[1, 2])  # needs more
        assert "took longer" in page.hear("refused", id=3)["message"]
        for _ in range(2):
            page.say("undo")
        assert page.hear("curves", of="a = 1\n")["faults"] == []


FAULT = {"key": "a", "message": "is too small", "value": "2", "hint": "", "line": 1}


def judging(job: Job, seconds: float) -> Mapping[str, Any]:
    """What jobs give: findings meet a fault at 2, the build at 3, and findings are slow at 4."""
    if job.kind == "build" and "3" in job.text:
        return {"faults": [FAULT], "files": []}
    if job.kind != "findings" or "1" in job.text:
        return computed(job, seconds)
    if "2" in job.text:
        return {"faults": [FAULT]}
    if "4" in job.text:
        raise Refused(f"findings: took longer than {seconds:g} s")
    return {"faults": [], "verdict": "1 finding.", "findings": [{"severity": "warning"}]}


def test_what_has_no_verdict_is_told_to_have_none(folder: Path) -> None:
    """A fault that only the findings or the files meet counts, and so does what is too slow."""
    with served(folder, "cam.toml", judging) as server, server.page() as page:
        page.say("hello")
        page.hear("verdict", revision=0, severity="waiting")
        page.say("text", id=2, text="a = 2\n")
        assert page.hear("curves", answers=2)["faults"] == []
        assert page.hear("verdict", revision=1, severity="invalid")["faults"] == [FAULT]
        page.say("text", id=3, text="a = 3\n")
        page.hear("curves", answers=3)
        verdict = page.hear("verdict", revision=2, severity="warning")
        assert (verdict["sentence"], verdict["faults"]) == ("1 finding.", [])
        page.say("build", id=4)
        assert page.hear("verdict", severity="invalid")["faults"] == [FAULT]
        assert page.hear("built", answers=4)["files"] == []
        with server.page() as other:
            other.say("hello")
            assert other.hear("verdict")["severity"] == "invalid"
        page.say("text", id=5, text="a = 4\n")
        verdict = page.hear("verdict", revision=3, severity="unknown")
        assert "took longer than 60 s" in verdict["sentence"]
        page.say("text", id=6, text="")
        page.hear("verdict", revision=4, severity="unknown")


REFUSED: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("nonsense", {}, "kind must be one of"),
    ("change", {"handle": "x", "to": [1, 2]}, "only edits are known here"),
    ("open", {"path": "../cam.toml"}, "a path in the folder"),
    ("open", {"path": "none.toml"}, "there is no such file"),
    ("save", {"path": "/tmp/cam.toml"}, "a path in the folder"),
    ("new", {"template": "nonsense"}, "there is no template"),
    ("text", {"text": "\ud800"}, "not text that UTF-8 can encode"),
)


def test_refusals_are_sentences(folder: Path) -> None:
    with greeted(folder, "cam.toml") as page:
        for number, (kind, arguments, sentence) in enumerate(REFUSED):
            page.say(kind, id=number, **arguments)
            assert sentence in page.hear("refused", id=number)["message"]
        page.socket.send("{")
        assert "must be JSON" in page.hear("refused", id=None)["message"]
        page.say("text", id=9, text="a = 3\n")
        assert page.hear("curves", answers=9)["text"] == "a = 3\n"
        page.socket.send(b"bytes")
        with pytest.raises(Exception, match="1003"):
            page.hear("state", saved=7)


def looked_at(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Grows with each look at the files that a scene names."""
    looks: list[str] = []
    original = NamedFiles.changed

    async def changed(self: NamedFiles, text: str, folder: Path) -> bool:
        found = await original(self, text, folder)
        looks.append(text)
        return found

    monkeypatch.setattr(NamedFiles, "changed", changed)
    return looks


def test_a_scene_is_shown_anew_when_a_file_that_it_names_has_changed(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("camgeo_export.designer.session.EVERY", 0.02)
    looks = looked_at(monkeypatch)
    (folder / "lift.csv").write_text("0, 0\n")
    (folder / "cam.toml").write_text('file = "lift.csv"\n')

    def reading(job: Job, seconds: float) -> Mapping[str, Any]:
        return {**computed(job, seconds), "read": (Path(job.folder) / "lift.csv").read_text()}

    with greeted(folder, "cam.toml", reading) as page:
        page.hear("findings", read="0, 0\n")
        seen = len(looks)
        until("a look at the files", lambda: len(looks) > seen + 1)
        (folder / "lift.csv").write_text("0, 1\n")
        assert page.hear("curves", read="0, 1\n")["revision"] == 0
        page.hear("findings", read="0, 1\n")


def test_a_file_changed_on_disk_is_told_and_not_overwritten(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("camgeo_export.designer.session.EVERY", 0.02)
    with greeted(folder, "cam.toml") as page:
        page.say("change", id=1, edits={"a": 2})
        (folder / "cam.toml").write_bytes(b"a = 9\n")
        page.hear("state", disk="changed")
        assert "changed on disk" in page.hear("told")["message"]
        page.say("save", id=2)
        refused = page.hear("refused", id=2)
        assert (refused["force"], "changed on disk" in refused["message"]) == (True, True)
        assert (folder / "cam.toml").read_bytes() == b"a = 9\n"
        page.say("reload")
        assert page.hear("state", disk="same", saved=True)["text"] == "a = 9\n"
        page.say("undo")
        assert page.hear("state", saved=False, redo="cam.toml from disk")["text"] == "a = 2\n"
        page.say("save", force=True)
        page.hear("state", saved=True)
    assert (folder / "cam.toml").read_bytes() == b"a = 2\n"


def test_without_a_scene_there_are_templates_and_the_folder(folder: Path) -> None:
    with greeted(folder) as page:
        state = page.hear("state")
        assert (state["file"], state["text"], state["saved"]) == (None, "", True)
        assert page.hear("curves")["charts"] == []
        page.say("new", template="translating-roller")
        assert "[follower]" in page.hear("state", file=None, saved=False)["text"]
        page.say("save", id=1)
        assert "needs a name" in page.hear("refused", id=1)["message"]
        page.say("open", path="other.toml")
        assert page.hear("state", file="other.toml")["text"] == "b = 2\n"
        assert "unsaved edits of the new scene are kept" in page.hear("told")["message"]


def test_what_is_built_is_downloaded(folder: Path) -> None:
    with served(folder, "cam.toml") as server, server.page() as page:
        page.say("build", id=1, formats=["dxf"])
        assert page.hear("busy")["what"] == "build"
        (file,) = page.hear("built", answers=1)["files"]
        assert (file["name"], file["size"]) == ("cam ä.dxf", 3)
        reply = server.get(file["url"])
        assert (reply.status, reply.text) == (200, b"cam")  # type: ignore[attr-defined]  # see Served.get
        assert reply.headers["content-disposition"].startswith('attachment; filename="cam__.dxf"')
        page.say("build", id=2)
        page.hear("built", answers=2)
        assert server.get(file["url"]).status == 404
        assert server.get("/files/all.zip").status == 200


def test_a_page_that_takes_nothing_holds_up_no_other(server: Served) -> None:
    with server.page() as idle, server.page() as page:
        idle.say("hello")
        for value in range(100):
            page.say("change", id=value, edits={"a": value})
            page.hear("curves", answers=value)
        assert idle.hear("curves", revision=page_revision(server))["text"] == "a = 99\n"


def page_revision(server: Served) -> int:
    return server.session._revision


HOSTILE = (
    "</script><script>alert(1)</script><img src=x onerror=alert(1)> javascript:alert(1) \u2028"
)


def test_texts_of_a_scene_are_data_and_never_part_of_a_page(folder: Path) -> None:
    name = "a<b>&'javascript:.toml"
    (folder / name.replace(":", "")).write_text(f'name = "{HOSTILE}"\n')
    with served(folder, "cam.toml") as server, server.page() as page:
        page.say("text", id=1, text=f'name = "{HOSTILE}"\n')
        assert page.hear("curves", answers=1)["text"] == f'name = "{HOSTILE}"\n'
        page.say("hello")
        assert name.replace(":", "") in page.hear("state", saved=False)["folder_files"]
        reply = server.get("/")
        assert b"alert" not in reply.text  # type: ignore[attr-defined]  # see Served.get
        assert b"<b>" not in reply.text  # type: ignore[attr-defined]  # see Served.get


@pytest.mark.parametrize(
    "name", ['a"b.dxf', "a\r\nX: 1.dxf", "../a.dxf", "</script>.dxf", "ä\u202e.dxf", "all.zip"]
)
def test_names_of_files_stay_names(folder: Path, name: str) -> None:
    def built(job: Job, seconds: float) -> Mapping[str, Any]:
        if job.kind == "build":
            return {"files": [{"name": name, "bytes": "Y2Ft"}], "faults": []}
        return computed(job, seconds)

    with served(folder, "cam.toml", built) as server, server.page() as page:
        page.say("build", id=1)
        (file,) = page.hear("built", answers=1)["files"]
        assert file["url"].isascii()
        assert not {*file["url"]} & {*'"<>\r\n'}
        reply = server.get(file["url"])
        if reply.status == 200:
            assert reply.text == b"cam"  # type: ignore[attr-defined]  # see Served.get
            assert reply.headers["content-disposition"].startswith("attachment; ")
            assert "X" not in reply.headers


# Jobs ---------------------------------------------------------------------------------------------
# Jobs of a session: their heads are read without the rest, and what is outdated is given up.


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
    assert read_head(text, (last,)) == {key: table[key] for key in expected}


def test_what_follows_the_head_is_not_read() -> None:
    assert read_head(b'{"faults": [], "text": "a", "label": "b", nonsense', ("label",)) == {
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

    def compute(job: Job, _: float) -> JobResult:
        begun[job.kind].set()
        happened("the end of the job", ended)
        if cancelled:
            raise Refused("was cancelled")
        return JobResult(b"{}")

    def cancel(kind: str) -> None:
        cancelled.append(kind)
        ended.set()

    async def ask() -> JobResult:
        jobs = Jobs(Desk(tmp_path, tmp_path / "states"), compute, cancel)
        asked = asyncio.create_task(jobs.do("findings"))
        more = [asyncio.create_task(jobs.do("solid"))] if other else []
        for kind in ("findings", *["solid"] * other):
            await asyncio.to_thread(happened, kind, begun[kind])
        clock.now += 5.0
        jobs.cancel_overdue("findings", 5.0)
        assert cancelled == []
        clock.now += 0.5
        jobs.cancel_overdue("findings", 5.0, unless="solid")
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
