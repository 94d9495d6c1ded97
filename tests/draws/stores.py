"""Random damages of a sweep's store: it is refused, or its rows are the same.

    python -m tests.draws.stores [--count N] [--seed HEX] [--rows FILE]

Cells, rows, tables, headers, pages, bytes and SQLite's files beside the store are changed, of
stores that are finished, half done, killed in their run and of the first format. Whatever was
changed, resuming it gives the rows that were computed, or an error of camgeo that names the file
and what helps, and leaves the file as it is; replacing it gives these rows in a sound file, unless
the file is not known as a store any more.
"""

from __future__ import annotations

import shutil
import sqlite3
import struct
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, nullcontext
from pathlib import Path
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.studies.sweep.family import Family, Point
from camgeo.studies.sweep.rows import Chunks, DesignRow, Work, parse_questions
from camgeo.studies.sweep.sweep import Existing, Heading, Store, sweep
from tests.draws.run import Case, parser_of, run_cases
from tests.sweep.families import SETZHUB, family

ASK: Final = ("largest-acceleration", "laws")

FAMILY: Final = family("follower.base_radius=45:60:10", "motion.2.law=modified-sine,scca")

HELPS: Final = ("--force", "delete it", "resume the run later", "another process")
"""What a message says of the way out."""

UNKNOWN: Final = ("is not a store of a sweep", "of another program")
"""What is said of a file that is not replaced: it may be somebody else's."""

BESIDE: Final = ("-wal", "-shm", "-journal")

PAGE: Final = 4096

ENDLESS: Final = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n"

FIRST_FORMAT: Final = """
CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID;
CREATE TABLE designs (point TEXT PRIMARY KEY, "a", units TEXT, reason TEXT) WITHOUT ROWID;
INSERT INTO sweep VALUES ('format', 'camgeo sweep 1');
"""

Generator = np.random.Generator


class Known:
    """An engine that has computed all rows before."""

    name = "known"

    def __init__(self, found: Family, ask: tuple[str, ...] = ASK) -> None:
        self.work = Work.for_family(found, parse_questions(Design(found.scene), ask))
        points = list(found.points())
        self.by_point: dict[Point, DesignRow] = dict(
            zip(points, self.work.rows(points), strict=True)
        )

    def rows(self, _: Work, points: Iterator[Point]) -> Chunks:
        while chunk := tuple(point for _, point in zip(range(5), points, strict=False)):
            yield tuple(self.by_point[point] for point in chunk)

    def held(self) -> AbstractContextManager[None]:
        return nullcontext()


class Stores:
    """Stores to damage, in a folder.

    Attributes
    ----------
    known : the rows of the family.
    kinds : the files of a finished store, one half done, and one killed while it was written.
    other : a finished store of another scene.
    """

    def __init__(self, folder: Path) -> None:
        self.known = Known(FAMILY)
        heading = Heading.for_family(FAMILY, self.known.work)
        rows = list(self.known.by_point.values())
        self.kinds = [folder / name for name in ("finished", "half", "killed")]
        self.other = folder / "other"
        scene = SETZHUB.with_values({"cam.speed": 91})
        other = Known(family("follower.base_radius=45:60:10", "motion.2.law=scca", scene=scene))
        of_other = Heading.for_family(family(scene=scene), other.work)
        stores = zip([*self.kinds[:2], self.other], [heading, heading, of_other],
                     [rows, rows[:9], list(other.by_point.values())], strict=True)  # fmt: skip
        for path, its, kept in stores:
            with closing(Store(path, its)) as store:
                store.add(kept)
                store.settle()
        running = folder / "running"
        with closing(Store(running, heading)) as store:
            store.add(rows[:5])
            store.add(rows[5:14])
            for end in ("", "-wal"):
                shutil.copy(f"{running}{end}", f"{self.kinds[2]}{end}")


def chosen_cell(rng: Generator, database: sqlite3.Connection) -> tuple[str, str, str]:
    """A table, one of its columns, and the value that marks one of its rows."""
    table = str(rng.choice(["designs", "designs", "designs", "sweep"]))
    columns = [row[1] for row in database.execute(f"PRAGMA table_info({table})")]
    keys = [row[0] for row in database.execute(f"SELECT {columns[0]} FROM {table}")]
    return table, str(rng.choice(columns)), keys[rng.integers(len(keys))]


def a_cell(rng: Generator, path: Path, _: Stores) -> str:
    """Another value, or the same one in another type."""
    with closing(sqlite3.connect(path)) as database:
        table, column, key = chosen_cell(rng, database)
        name = '"' + column + '"'
        values = [
            "NULL", "'[]'", "'[\"mm\"'", "x'ff00'", "CAST(x'c3' AS TEXT)", "-1", "1e308", "''",
            f"CAST({name} AS TEXT)", f"CAST({name} AS BLOB)", f"{name} + 1", f"{name} || ' '",
            f"1.0000000001 * {name}", f"substr({name}, 1, 3)", f"abs({name})",
            "printf('%.*c', 70000000, 'x')", "'abc'", "0.0", "'NaN'", "9e999",
        ]  # fmt: skip
        what = str(rng.choice(values))
        first = "point" if table == "designs" else "name"
        database.execute(f"UPDATE OR IGNORE {table} SET {name} = {what} WHERE {first} = ?", [key])
        database.commit()
    return f"{table}.{column} of {key} = {what}"


def some_rows(rng: Generator, path: Path, stores: Stores) -> str:
    """Rows that are gone, exchanged, invented, or of another store."""
    ways = {
        "gone": "DELETE FROM designs WHERE unicode(checksum) % 3 = 0",
        "all gone": "DELETE FROM designs",
        "states nothing": "DELETE FROM sweep",
        "states less": "DELETE FROM sweep WHERE name IN ('scene', 'name', 'camgeo')",
        "renamed": "UPDATE OR REPLACE designs SET point = replace(point, '45', '50')",
        "mixed": 'UPDATE designs SET "laws" = (SELECT max(laws) FROM designs)',
        "one for all": "UPDATE designs SET checksum = (SELECT min(checksum) FROM designs)",
        "invented": "INSERT INTO designs(point, laws) VALUES ('[45,\"x\"]', 'y')",
        "many facts": "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 999)"
        " INSERT INTO sweep SELECT i, i, i FROM n",
        "of another scene": "INSERT OR REPLACE INTO designs SELECT * FROM other.designs",
        "heading of another scene": "INSERT OR REPLACE INTO sweep SELECT * FROM other.sweep",
    }
    what = str(rng.choice(list(ways)))
    with closing(sqlite3.connect(path)) as database:
        database.execute("ATTACH ? AS other", [str(stores.other)])
        database.execute(ways[what])
        database.commit()
    return what


def the_tables(rng: Generator, path: Path, _: Stores) -> str:
    """Tables that are gone, other ones, or views; triggers; text of SQLite's own table."""
    ways = [
        "DROP TABLE designs", "DROP TABLE sweep", "DROP TABLE designs; DROP TABLE sweep",
        "ALTER TABLE designs ADD COLUMN x", "ALTER TABLE sweep ADD COLUMN x DEFAULT 1",
        "ALTER TABLE designs RENAME COLUMN units TO unit", "ALTER TABLE designs RENAME TO d",
        f"DROP TABLE designs; CREATE VIEW designs AS {ENDLESS}",
        f"DROP TABLE sweep; CREATE VIEW sweep AS {ENDLESS}",
        "ALTER TABLE designs RENAME TO d; CREATE VIEW designs AS SELECT * FROM d",
        "ALTER TABLE sweep RENAME TO s; CREATE VIEW sweep AS SELECT * FROM s",
        "CREATE TRIGGER t BEFORE INSERT ON designs BEGIN SELECT RAISE(ABORT, 'no'); END",
        f"CREATE TRIGGER t AFTER INSERT ON designs BEGIN SELECT count(*) FROM ({ENDLESS}); END",
        "CREATE TRIGGER t AFTER INSERT ON designs BEGIN UPDATE designs SET reason = 'x'; END",
        "CREATE INDEX i ON designs(laws)", "CREATE UNIQUE INDEX i ON designs(checksum)",
        "ALTER TABLE designs RENAME TO d; CREATE TABLE designs AS SELECT * FROM d",
        "PRAGMA writable_schema = ON; UPDATE sqlite_master SET sql = replace(sql, 'units', 'u')",
        "PRAGMA writable_schema = ON; UPDATE sqlite_master SET sql = 'nonsense'",
        "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = 2",
        "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = 99",
        "PRAGMA writable_schema = ON; DELETE FROM sqlite_master WHERE name = 'sweep'",
        "PRAGMA user_version = 1", "PRAGMA user_version = 3", "PRAGMA user_version = -7",
        "PRAGMA application_id = 0", "PRAGMA application_id = 5", "PRAGMA journal_mode = WAL",
        "PRAGMA page_size = 1024; VACUUM", "ANALYZE",
    ]  # fmt: skip
    what = str(rng.choice(ways))
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.executescript(what)
    return what


def the_header(rng: Generator, path: Path, _: Stores) -> str:
    """Some of the first 100 bytes."""
    data = bytearray(path.read_bytes())
    places = rng.integers(100, size=rng.integers(1, 4))
    for place in places:
        data[place] = rng.integers(256)
    path.write_bytes(data)
    return f"header at {[*map(int, places)]}"


def the_bytes(rng: Generator, path: Path, _: Stores) -> str:
    """Single bits, runs, whole pages, and the length of the file."""
    data = bytearray(path.read_bytes())
    pages = len(data) // PAGE
    one, other = (PAGE * int(each) for each in rng.integers(pages, size=2))
    at, size = int(rng.integers(len(data))), int(rng.integers(1, 300))
    match what := int(rng.integers(8)):
        case 0 | 1:
            for place in rng.integers(len(data), size=rng.integers(1, 60)):
                data[place] ^= 1 << int(rng.integers(8))
        case 2:
            data[at : at + size] = rng.bytes(len(data[at : at + size]))
        case 3:
            data[one : one + PAGE] = bytes(PAGE)
        case 4:
            data[one : one + PAGE], data[other : other + PAGE] = (
                data[other : other + PAGE], data[one : one + PAGE])  # fmt: skip
        case 5:
            del data[at:]
        case 6:
            data += rng.bytes(size)
        case 7:
            del data[at : at + size]
    path.write_bytes(data)
    return f"bytes, way {what}, pages {one // PAGE} and {other // PAGE}, {size} at {at}"


def a_cell_in_place(rng: Generator, path: Path, _: Stores) -> str:
    """A digit or letter of what the file has, found in its bytes."""
    data = bytearray(path.read_bytes())
    words = [b"modified-sine", b"mm/s^2", struct.pack(">d", 45.0), b"scca", b"setzhub"]
    places = [at for word in words for at in range(len(data)) if data.startswith(word, at)]
    at = places[rng.integers(len(places))] + int(rng.integers(4))
    data[at] ^= 1 << int(rng.integers(7))
    path.write_bytes(data)
    return f"bit at {at}"


def what_lies_beside(rng: Generator, path: Path, stores: Stores) -> str:
    """SQLite's own files, of nobody, of another store, or of an earlier state."""
    end = str(rng.choice(BESIDE))
    wal = Path(f"{stores.kinds[2]}-wal").read_bytes()
    match what := int(rng.integers(4)):
        case 0:
            data = rng.bytes(int(rng.integers(1, 9000)))
        case 1:
            data = stores.other.read_bytes()
        case 2:
            data = wal[: int(rng.integers(len(wal)))]
        case _:
            flipped = bytearray(wal)
            flipped[rng.integers(len(wal))] ^= 1
            data = bytes(flipped)
    Path(f"{path}{end}").write_bytes(data)
    return f"{end}, way {what}"


def another_file(rng: Generator, path: Path, stores: Stores) -> str:
    """Something else under the name."""
    for end in BESIDE:
        Path(f"{path}{end}").unlink(missing_ok=True)
    match what := int(rng.integers(6)):
        case 0:
            path.write_bytes(b"")
        case 1:
            path.write_text("follower.base_radius,laws\n45,x\n" * 40)
        case 2:
            path.write_bytes(rng.bytes(5000))
        case 3:
            shutil.copy(stores.other, path)
        case _:
            path.unlink()
            with closing(sqlite3.connect(path)) as database:
                mine = f"CREATE TABLE mine (a); CREATE VIEW sweep AS {ENDLESS};"
                database.executescript(mine if what == 4 else FIRST_FORMAT)
    return f"another file, way {what}"


DAMAGES: Final[tuple[Callable[[Generator, Path, Stores], str], ...]] = (
    a_cell, a_cell, a_cell, some_rows, the_tables, the_tables, the_header, the_bytes, the_bytes,
    a_cell_in_place, what_lies_beside, another_file,
)  # fmt: skip


def fault(path: Path, stores: Stores, existing: Existing) -> tuple[str, str]:
    """What is wrong with the answer, "" if nothing is; and with which words a store is refused."""
    try:
        with closing(
            sweep(FAMILY, ASK, store=path, existing=existing, engine=stores.known)
        ) as result:
            rows = list(result.rows)
    except CamgeoError as error:
        said = str(error)
        missing = [word for word in (str(path),) if word not in said]
        if missing or not any(word in said for word in HELPS):
            return f"says too little: {said}", said
        return "", said
    except Exception as error:
        return f"is an internal error: {error!r}", ""
    if rows != [*stores.known.by_point.values()]:
        return "has other rows", ""
    return "", ""


def miss(path: Path, stores: Stores, *, is_alone: bool) -> str:
    """What is wrong with what becomes of a damaged store, resumed and replaced; "" if nothing."""
    before = path.read_bytes()
    wrong, said = fault(path, stores, "resume")
    if wrong:
        return f"resumed it {wrong}"
    if said and is_alone and path.read_bytes() != before:
        return f"is refused and changed: {said}"
    if not said and (again := fault(path, stores, "resume")) != ("", ""):
        return f"resumed again: {again}"
    wrong, said = fault(path, stores, "replace")
    if wrong or said:
        return "" if any(word in said for word in UNKNOWN) else f"replaced: {wrong or said}"
    with closing(sqlite3.connect(path)) as database:
        if database.execute("PRAGMA integrity_check").fetchone() != ("ok",):
            return "replaced it is not sound"
    return ""


def misses(count: int, seed: int) -> Iterator[Case]:
    """Each case: its number and what was damaged, and its miss."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stores = Stores(folder)
        path = folder / "runs.sqlite"
        for number in range(count):
            rng = np.random.default_rng([seed, number])
            kind = stores.kinds[rng.integers(len(stores.kinds))]
            for end in ("", *BESIDE):
                Path(f"{path}{end}").unlink(missing_ok=True)
                if Path(f"{kind}{end}").exists():
                    shutil.copy(f"{kind}{end}", f"{path}{end}")
            damage = DAMAGES[rng.integers(len(DAMAGES))]
            what = f"{number}: {kind.name}, {damage.__name__}: {damage(rng, path, stores)!r}"
            is_alone = not any(Path(f"{path}{end}").exists() for end in BESIDE)
            missed = miss(path, stores, is_alone=is_alone)
            yield what, [missed] if missed else []


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 300), lambda asked: misses(asked.count, asked.seed)))
