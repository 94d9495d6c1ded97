"""`python -m tests.sweep.driver STORE WHERE COUNT LOG`: resumes a sweep, to be killed meanwhile.

WHERE is how many processes a pool has, or the address of a cluster. Each design that is begun adds
its key to LOG. After each chunk it prints the number of rows stored, and of its processes, and goes
on when a line comes.
"""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Final

from camgeo.studies.sweep import rows
from camgeo.studies.sweep import sweep as running
from camgeo.studies.sweep.family import Family
from camgeo.studies.sweep.rows import Question, Work
from tests.sweep.families import LAWS, family
from tests.sweep.logged import Logged

ASK: Final = ("transmission-angle", "largest-acceleration")

CHUNKS: Final = 60
"""Of the family, however fast the machine is; the first ones are smaller."""

NEVER: Final = 1e9
"""Seconds that a chunk may take: its size is limited in designs alone."""


def killed_family(count: int) -> Family:
    """Setzhub with so many base radii and laws."""
    return family(f"follower.base_radius=45:60:{count // 2}", LAWS)


def in_chunk(count: int) -> int:
    """Designs of a chunk of a family of so many."""
    return max(count // CHUNKS, 1)


def main() -> None:
    """Resume the store."""
    store, where, count, log = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4]
    rows.CHUNK = NEVER  # type: ignore[misc]  # smaller chunks here
    rows.MOST_IN_CHUNK = in_chunk(int(count))  # type: ignore[misc]  # as above
    pool = where.isdecimal()
    chosen = rows.engine_of("pool" if pool else "cluster", int(where) if pool else where)

    def logged(found: Family, asked: Iterable[Question]) -> Logged:
        work = Work.for_family(found, asked)
        return Logged(work.text, work.contents, work.keys, work.questions, work.versions, log)

    def say(words: str) -> None:
        done = int(words.split()[0].replace(",", ""))
        workers = " ".join(str(each.pid) for each in multiprocessing.active_children())
        sys.stdout.write(f"{done} {workers}\n")
        sys.stdout.flush()
        sys.stdin.readline()

    vars(running)["Work"] = SimpleNamespace(for_family=logged)
    found = killed_family(count)
    running.sweep(found, ASK, store=store, existing="resume", engine=chosen, progress=say).close()


if __name__ == "__main__":
    main()
