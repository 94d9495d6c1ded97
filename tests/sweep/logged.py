"""Work that says which designs it begins, in whichever process, and work that ends its process."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from camgeo.studies.sweep.family import Point, mark
from camgeo.studies.sweep.rows import Chunks, DesignRow, Work

if TYPE_CHECKING:
    from camgeo.lazy import Ledger


@dataclass(frozen=True)
class Logged(Work):
    """Work that adds a line to a file for each design that is begun.

    Attributes
    ----------
    log : path of the file.
    """

    log: str = ""

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[DesignRow]:
        """See `Work.rows`."""
        with Path(self.log).open("ab", buffering=0) as file:  # lines of processes do not mix
            file.write("".join(f"{mark(point)}\n" for point in points).encode())
        return super().rows(points, ledger)


@dataclass(frozen=True)
class Deadly(Work):
    """Work of which one design, 47, kills its process, and another, 50, does so the first time.

    Attributes
    ----------
    mark : path of a file that is made the first time.
    """

    mark: str = ""

    @classmethod
    def made_of(cls, plain: Work, mark: Path) -> Deadly:
        return cls(
            plain.text, plain.contents, plain.keys, plain.questions, plain.versions, str(mark)
        )

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[DesignRow]:
        """See `Work.rows`."""
        mark = Path(self.mark)
        first = not mark.exists()
        if any(point[0] == 47 or (point[0] == 50 and first) for point in points):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().rows(points, ledger)


def by_point(chunks: Chunks) -> dict[Point, DesignRow]:
    """All rows, each point once."""
    found = [row for chunk in chunks for row in chunk]
    rows = {row.point: row for row in found}
    assert len(rows) == len(found)
    return rows
