"""Writes docs/bill.md: `python docs/bill_page.py`, some minutes on a machine with nothing else.

Builds every fixture scene within each tolerance. Seconds are those of one machine, and no test
checks them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import camgeo
from camgeo.accuracy.bill import STAGES, BillRow, bill_rows

PAGE: Final = Path(__file__).with_name("bill.md")
SCENES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

TOLERANCES: Final = (1e-1, 1e-2, 1e-3, 1e-4)
"""[mm]"""

HEAD: Final = """# The bill of the fixture scenes

<!-- Made by docs/bill_page.py; change it there. -->

What a build takes, from the loaded scene to the last file, all formats of the scene: seconds by
stage, on one machine and rounded to two digits; the pieces of the flanks of all discs; the bytes of
all files with the certificate; and the machining time of all programs. `camgeo accuracy SCENE
--bill` makes it for one scene; [what accuracy costs](accuracy.md) tells what is in each stage.

| scene | tolerance [mm] | evaluate | fit | prove | write | read | total [s] | pieces | bytes \
| machining [s] |
|---|---|---|---|---|---|---|---|---|---|---|
"""


def scenes() -> list[str]:
    """Names of the fixture scenes."""
    return sorted(path.stem for path in SCENES.glob("*.toml"))


def measure(name: str, tolerances: Sequence[float] = TOLERANCES) -> tuple[BillRow, ...]:
    """The builds of a scene."""
    return bill_rows(camgeo.load(SCENES / f"{name}.toml"), tolerances)


def line(name: str, row: BillRow) -> str:
    """The line of a build; of one that is impossible with the reason."""
    if row.fault:
        return f"| {name} | {row.tolerance:g} | {row.fault} |{' |' * 8}\n"
    seconds = [row.stages[stage] for stage in STAGES]
    cells = [name, f"{row.tolerance:g}", *map(_seconds, (*seconds, row.total))]
    cells += [f"{row.pieces:,}", f"{row.size:,}", _seconds(row.machining_seconds)]
    return f"| {' | '.join(cells)} |\n"


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}" if value < 10.0 else f"{value:,.0f}"


def page(found: Mapping[str, Sequence[BillRow]]) -> str:
    """The page's text, from the builds of the scenes by name."""
    return HEAD + "".join(line(name, row) for name, rows in found.items() for row in rows)


if __name__ == "__main__":
    PAGE.write_text(page({name: measure(name) for name in scenes()}), encoding="utf-8")
