"""Which tests are quick: `-m quick` runs those of the modules that take no more than a second.

`benchmarks/test_suite.py --write` has measured which take more; of a folder that has no others, the
one that takes least is quick. Of what is built end to end, one scene is.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Final

TESTS: Final = Path(__file__).parent

DEAR: Final[dict[str, float]] = json.loads((TESTS / "dear_modules.json").read_text("utf-8"))
"""CPU of the modules that take more than a second [s], by their paths in this folder."""

BUILT: Final = "setzhub"
"""The scene of which the quick tests look at what was built."""

BUILDS: Final = "end_to_end"
"""The folder in which scenes are built."""


def chosen(modules: Iterable[str], dear: dict[str, float]) -> frozenset[str]:
    """The quick ones of the `modules`, paths as in `dear`."""
    folders: dict[str, list[str]] = {}
    for module in modules:
        folders.setdefault(module.partition("/")[0] if "/" in module else "", []).append(module)
    quick = {module for each in folders.values() for module in each if module not in dear}
    least = (min(each, key=lambda module: dear.get(module, 0.0)) for each in folders.values())
    return frozenset(quick.union(least))


QUICK: Final = chosen(
    (path.relative_to(TESTS).as_posix() for path in TESTS.rglob("test_*.py")), DEAR
)
"""The quick modules."""
