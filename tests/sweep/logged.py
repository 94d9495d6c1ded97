"""Work that says which designs it begins, in whichever process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from camgeo.studies.sweep.family import Point, mark
from camgeo.studies.sweep.rows import Row, Work

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

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[Row]:
        """See `Work.rows`."""
        with Path(self.log).open("ab", buffering=0) as file:  # lines of processes do not mix
            file.write("".join(f"{mark(point)}\n" for point in points).encode())
        return super().rows(points, ledger)
