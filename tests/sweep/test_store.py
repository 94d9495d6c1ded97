"""Stores: what they keep whatever happens, and which of them are refused."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from camgeo.design.design import Design
from camgeo.errors import CamgeoError, FileError, OutputError
from camgeo.studies.sweep import sweep as local
from camgeo.studies.sweep.family import Family, Point
from camgeo.studies.sweep.rows import Chunks, DesignRow, Work, compute_rows, parse_questions
from camgeo.studies.sweep.sweep import (
    Heading,
    Store,
    SweepResult,
    file_system_kind,
    mounted,
    progress_words,
    sweep,
)
from tests.draws.stores import DAMAGES, FIRST_FORMAT, misses
from tests.sweep.families import SETZHUB, family

ASK = ("largest-acceleration", "laws")


class Counting:
    """A loop in chunks of two that counts the designs, and stops after `most` of them."""

    name = "counting"

    def __init__(self, most: int = 1000, error: type[BaseException] = KeyboardInterrupt) -> None:
        self.points: list[Point] = []
        self.most = most
        self.error = error

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        while chunk := tuple(point for _, point in zip(range(2), points, strict=False)):
            if len(self.points) >= self.most:
                raise self.error
            self.points += chunk
            yield compute_rows(work, chunk)

    def held(self) -> AbstractContextManager[None]:
        return nullcontext()


def run(path: Path | None, engine: Counting | None = None, **given: object) -> SweepResult:
    return sweep(family(), ASK, store=path, engine=engine or Counting(), **given)  # type: ignore[arg-type]  # options of it


def rows(result: SweepResult) -> list[DesignRow]:
    with closing(result):
        return list(result.rows)


def heading(found: Family, *ask: str) -> Heading:
    return Heading.for_family(
        found, Work.for_family(found, parse_questions(Design(found.scene), ask or ASK))
    )


def whole(path: Path, count: int) -> None:
    """The file alone is a sound database with so many rows."""
    assert [each.name for each in path.parent.iterdir()] == [path.name]
    with closing(sqlite3.connect(path)) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert database.execute("SELECT count(*) FROM designs").fetchone() == (count,)


def test_a_store_has_the_rows_of_the_loop_and_is_one_file(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    kept, memory = rows(run(path)), rows(run(None))
    assert kept == memory
    assert [row.point for row in kept] == list(family().points())
    assert [row.units for row in kept] == [("mm/s^2", "")] * 8
    whole(path, 8)
    with closing(sqlite3.connect(path)) as database:
        columns = '"follower.base_radius", "motion[2].law", "largest-acceleration", "laws"'
        found = database.execute(f"SELECT {columns} FROM designs").fetchall()
    assert sorted(found) == sorted((*row.point, *row.values) for row in kept)


def test_others_may_read_a_store_whose_rows_are_still_read(tmp_path: Path) -> None:
    with closing(run(tmp_path / "runs.sqlite")) as result:
        next(result.rows)
        whole(tmp_path / "runs.sqlite", 8)


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
def test_what_was_finished_is_kept_and_only_the_rest_is_computed(
    tmp_path: Path, error: type[BaseException]
) -> None:
    path = tmp_path / "runs.sqlite"
    first = Counting(5, error)
    with pytest.raises(error):
        run(path, first)
    whole(path, 6)
    second = Counting()
    result = run(path, second, existing="resume")
    assert result.computed == len(second.points) == 2
    assert first.points + second.points == list(family().points())
    assert rows(result) == rows(run(None))
    again = Counting()
    assert len(rows(run(path, again, existing="resume"))) == 8
    assert again.points == []


def test_a_larger_family_of_the_same_keys_goes_on(tmp_path: Path) -> None:
    path, engine = tmp_path / "runs.sqlite", Counting()
    run(path).close()
    larger = family("follower.base_radius=45:60:7", "motion.2.law=modified-sine,polynomial-345")
    result = sweep(larger, ASK, store=path, existing="resume", engine=engine)
    assert len(engine.points) == result.computed == 6
    assert [row.point for row in rows(result)] == list(larger.points())


# Stores that are refused --------------------------------------------------------------------------


def test_a_store_that_exists_is_neither_overwritten_nor_extended_unasked(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    run(path).close()
    before = path.read_bytes()
    with pytest.raises(OutputError, match="exists: resume it, replace it"):
        run(path)
    assert path.read_bytes() == before
    replaced = Counting()
    run(path, replaced, existing="replace").close()
    assert len(replaced.points) == 8
    whole(path, 8)


@pytest.mark.parametrize(
    ("other", "ask", "message"),
    [
        (family(scene=SETZHUB.with_values({"cam.speed": 91})), ASK, "is of another scene"),
        (family("follower.base_radius=45,46"), ASK, "varies other keys: follower.base_radius, mo"),
        (family(), ("laws",), "answers other questions: largest-acceleration, laws in place"),
    ],
)
def test_a_store_of_something_else_is_refused_and_left_alone(
    tmp_path: Path, other: Family, ask: tuple[str, ...], message: str
) -> None:
    path = tmp_path / "runs.sqlite"
    run(path).close()
    before = path.read_bytes()
    with pytest.raises(FileError) as error:
        sweep(other, ask, store=path, existing="resume")
    assert f"{path} {message}" in str(error.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize("name", ["camgeo", "numpy", "python"])
def test_a_store_of_another_version_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "runs.sqlite"
    here = heading(family())
    work = replace(here.work, versions=replace(here.work.versions, **{name: "0.1"}))
    with closing(Store(path, replace(here, work=work))) as store:
        store.add(compute_rows(here.work, [(45, "modified-sine")]))
        store.settle()
    require_refused_then_made_anew(path, "another version of .*: 0.1 in place of")


def test_a_store_of_another_format_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    with closing(sqlite3.connect(path)) as database:
        database.executescript(FIRST_FORMAT)
    require_refused_then_made_anew(path, "is a store of format 1, without checksums")
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA user_version = 3")
    require_refused_then_made_anew(path, "is a store of format 3, not 2")


def require_refused_then_made_anew(path: Path, said: str) -> None:
    """What cannot be resumed is left alone, and the message says what replaces it."""
    before = path.read_bytes()
    with pytest.raises(FileError, match=f"{said}.*it was not changed; --force makes"):
        run(path, existing="resume")
    assert path.read_bytes() == before
    run(path, existing="replace").close()
    whole(path, 8)


def test_damaged_stores_are_refused_or_have_the_same_rows() -> None:
    found = list(misses(count=36, seed=2026))
    assert [each for each in found if each[1]] == []
    assert {re.split(", |: ", what)[2] for what, _ in found} == {each.__name__ for each in DAMAGES}


def test_a_row_that_was_changed_is_named(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    run(path).close()
    with closing(sqlite3.connect(path)) as database, database:
        changed = 'UPDATE designs SET "largest-acceleration" = "largest-acceleration" + 1e-9'
        database.execute(f'{changed} WHERE "follower.base_radius" = 50 AND "motion[2].law" > "n"')
    with pytest.raises(FileError) as error:
        run(path, existing="resume")
    design = "follower.base_radius = 50, motion[2].law = polynomial-345"
    assert f"{path} is damaged: the row of {design} was changed" in str(error.value)


# While it is written ------------------------------------------------------------------------------


def test_others_read_what_is_finished_while_it_is_written(tmp_path: Path) -> None:
    path, seen = tmp_path / "runs.sqlite", []

    class Read(Counting):
        def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
            for chunk in super().rows(work, points):
                yield chunk
                # It does not wait for the lock: that it is held is what is asked.
                with closing(sqlite3.connect(path, timeout=0.0)) as database:
                    seen.extend(database.execute("SELECT count(*) FROM designs").fetchone())
                    with pytest.raises(sqlite3.OperationalError, match="locked"):
                        database.execute("DELETE FROM designs")

    run(path, Read()).close()
    assert seen == [2, 4, 6, 8]
    whole(path, 8)


def test_a_reading_that_lasts_stops_neither_the_run_nor_its_end(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    with pytest.raises(KeyboardInterrupt):
        run(path, Counting(4))
    with closing(sqlite3.connect(path)) as database:
        reading = database.execute("SELECT point FROM designs")
        reading.fetchone()
        assert rows(run(path, existing="resume")) == rows(run(None))
        assert len(reading.fetchall()) == 3
    whole(path, 8)


@pytest.mark.parametrize("is_damaged", [False, True])
def test_what_is_replaced_is_there_until_the_first_rows_are(
    tmp_path: Path, is_damaged: bool
) -> None:
    path = tmp_path / "runs.sqlite"
    run(path).close()
    if is_damaged:
        path.write_bytes(path.read_bytes()[:-3000])
    before = path.read_bytes()
    with pytest.raises(KeyboardInterrupt):
        run(path, Counting(0), existing="replace")
    assert path.read_bytes() == before
    with pytest.raises(KeyboardInterrupt):
        run(path, Counting(1), existing="replace")
    whole(path, 2)


def test_a_file_of_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    path.write_bytes(b"not a database, but long enough to be taken for one" * 20)
    other = tmp_path / "other.sqlite"
    with closing(sqlite3.connect(other)) as database, database:
        database.execute("CREATE TABLE mine (a)")
    for file, message in ((path, "is not a store of a sweep"), (other, "of another program")):
        before = file.read_bytes()
        for existing in ("resume", "replace"):
            with pytest.raises(FileError, match=message):
                run(file, existing=existing)
        assert file.read_bytes() == before


@pytest.mark.parametrize(
    ("was", "becomes"),
    [(b'"polynomial', b'"3olynomial'), (b"CREATE TABLE designs", b"CREATE TAB\xccE d    ")],
)
def test_what_sqlite_finds_damaged_is_refused(tmp_path: Path, was: bytes, becomes: bytes) -> None:
    """A key out of order, behind which others are not found; and a text that is none."""
    path = tmp_path / "runs.sqlite"
    run(path).close()
    before = path.read_bytes()
    assert was in before
    for count in range(1, before.count(was) + 1):
        parts = before.split(was)
        data = was.join(parts[:count]) + becomes + was.join(parts[count:])
        path.write_bytes(data)
        with pytest.raises(FileError, match=r"runs\.sqlite is damaged: "):
            run(path, existing="resume")
        assert path.read_bytes() == data


def test_a_store_of_a_later_sqlite_is_read_and_left_alone(tmp_path: Path) -> None:
    """SQLite reads such a file and does not write it; byte 18 is the version of its writing."""
    path = tmp_path / "runs.sqlite"
    found = rows(run(path))
    data = bytearray(path.read_bytes())
    data[18] = 3
    path.write_bytes(data)
    assert rows(run(path, existing="resume")) == found
    with pytest.raises(FileError, match=r"runs\.sqlite is not a store of a sweep.*delete it"):
        run(path, existing="replace")
    assert path.read_bytes() == data


def test_a_second_writer_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    with closing(Store(path, heading(family()))) as first:
        for existing in ("resume", "replace"):
            with pytest.raises(OutputError, match="another process is writing it"):
                run(path, existing=existing)
        first.add(compute_rows(first.heading.work, [(45, "modified-sine")]))
    engine = Counting()
    run(path, engine, existing="resume").close()
    assert len(engine.points) == 7


def test_a_full_disk_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "runs.sqlite"
    with closing(Store(path, heading(family()))) as store:
        work = store.heading.work
        store.add(compute_rows(work, [(45, "modified-sine")]))
        pages = store._open.execute("PRAGMA page_count").fetchone()[0]
        store._open.execute(f"PRAGMA max_page_count={pages}")
        many = [DesignRow((float(k), "x" * 500), (1.0, 2.0), ("", "")) for k in range(100)]
        with pytest.raises(OutputError, match=r"the disk is full; the rows finished before are"):
            store.add(many)
    whole(path, 1)


def test_places_where_no_file_can_be(tmp_path: Path) -> None:
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    for path in (tmp_path / ("x" * 300), loop / "runs", tmp_path / "none" / "runs", tmp_path):
        for existing in ("resume", "replace"):
            with pytest.raises(OutputError, match="cannot be written"):
                run(path, existing=existing)


def test_a_network_file_system_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mounts = tmp_path / "mounts"
    mounts.write_text(f"/dev/sda / ext4 rw 0 0\nhost:/x {tmp_path} nfs4 rw 0 0\n")
    monkeypatch.setattr(local, "MOUNTS", mounts)
    with pytest.raises(OutputError, match=r"lies on a network file system \(nfs4\)"):
        run(tmp_path / "runs.sqlite")
    assert [each.name for each in tmp_path.iterdir()] == ["mounts"]


def test_the_innermost_mount_counts() -> None:
    lines = ["/dev/a / ext4", "h:/ /net nfs", "tmpfs /net/a\\040b tmpfs", "broken", "x /net cifs"]
    assert mounted(lines, Path("/home")) == "ext4"
    assert mounted(lines, Path("/net/x")) == "cifs"
    assert mounted(lines, Path("/net/a b/c")) == "tmpfs"
    assert mounted(lines, Path("/network")) == "ext4"
    assert mounted([], Path("/x")) == ""
    assert isinstance(file_system_kind(Path("/")), str)


# How far it is ------------------------------------------------------------------------------------


def test_progress_tells_rate_and_time_left() -> None:
    assert progress_words(50, 1000, 50, 0.5) == "50 of 1,000 designs, 100/s"
    assert progress_words(600, 1000, 500, 5.0) == "600 of 1,000 designs, 100/s, 4 s left"
    said: list[str] = []
    with closing(sweep(family(), ASK, engine=Counting(), progress=said.append)):
        assert said[-1].startswith("8 of 8 designs, ")


def test_nothing_is_stored_if_the_question_is_wrong(tmp_path: Path) -> None:
    with pytest.raises(CamgeoError):
        sweep(family(), ["nothing"], store=tmp_path / "runs.sqlite")
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_opened_leaves_nothing_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[sqlite3.Connection] = []
    connect = sqlite3.connect

    def noted(*arguments: Any, **options: Any) -> sqlite3.Connection:
        opened.append(connect(*arguments, **options))
        return opened[-1]

    monkeypatch.setattr(sqlite3, "connect", noted)
    with pytest.raises(OutputError):
        run(tmp_path, existing="replace")
    for each in opened:
        with pytest.raises(sqlite3.ProgrammingError, match="closed"):
            each.execute("SELECT 1")
