"""Which tests are quick: `-m quick` runs the modules that take no more than half a second.

`benchmarks/test_suite.py --write` measures which take longer. In a folder where all modules do, the
fastest one counts as quick, unless it takes more than `LONGEST`. Of the scenes built end to end,
only one is built.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Final

TESTS: Final = Path(__file__).parent

MODULES: Final = TESTS / "expensive_modules.json"

EXPENSIVE: Final[dict[str, float]] = json.loads(MODULES.read_text("utf-8"))
"""CPU time [s] of the modules that take more than half a second, by their paths in this folder."""

LONGEST: Final = 10.0
"""CPU time [s] of a module that is never quick."""

BUILT: Final = "setzhub"
"""The scene whose files the quick tests examine."""

BUILDS: Final = "end_to_end"
"""The folder in which scenes are built."""


def chosen(modules: Iterable[str], expensive: dict[str, float]) -> frozenset[str]:
    """The quick ones among `modules`, given as paths like those in `expensive`."""
    folders: dict[str, list[str]] = {}
    for module in modules:
        folders.setdefault(module.partition("/")[0] if "/" in module else "", []).append(module)
    quick = {module for each in folders.values() for module in each if module not in expensive}
    least = (min(each, key=lambda module: expensive.get(module, 0.0)) for each in folders.values())
    return frozenset(quick.union(each for each in least if expensive.get(each, 0.0) <= LONGEST))


QUICK: Final = chosen(
    (path.relative_to(TESTS).as_posix() for path in TESTS.rglob("test_*.py")), EXPENSIVE
)
"""The quick modules."""
