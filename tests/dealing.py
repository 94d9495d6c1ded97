"""How tests are dealt out to processes with `-n`: what is shared is made in one process alone.

Tests of one module go to one process. So do, from all modules of `end_to_end`, those of one
fixture scene, which is built once for them, and modules that share a result. What takes longest
goes first, so that all processes end at nearly the same time.

pytest-xdist has marks for this, which pytest 9.2 ignores without a word: a group is part of a
test's name in the one and no longer in the other. Here it follows from the name.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Final

from xdist.scheduler.loadscope import LoadScopeScheduling

from tests.quick import BUILDS, EXPENSIVE, TESTS

SCENES: Final = {path.stem for path in (TESTS.parent / "fixtures" / "scenes").glob("*.toml")}

SHARING: Final = {
    "answers/test_check.py": "answers",
    "answers/test_explain.py": "answers",
    "answers/test_table.py": "answers",
    "test_docs_effects.py": "answers",
    "stability/test_suite.py": "stability",
    "test_docs_pages.py": "stability",
}
"""Modules that share a result, with the name of their group."""

UNMEASURED: Final = 0.5
"""CPU time [s] of a module that is not among the expensive ones."""


def module_of(test: str) -> str:
    """The path in this folder of the module of the `test` "tests/PATH::NAME[PARAMETERS]"."""
    return test.partition("::")[0].removeprefix(f"{TESTS.name}/")


def group_of(test: str) -> str:
    """The group of tests that `test` goes with."""
    module = module_of(test)
    if module.startswith(f"{BUILDS}/"):
        parameters = test.partition("[")[2].partition("]")[0]
        for name in parameters.split("-"):
            if name in SCENES:
                return f"scene {name}"
    return SHARING.get(module, module)


def longest_first(tests: Sequence[str]) -> list[int]:
    """The order of `tests`, by their numbers: groups one after the other, the longest first."""
    sizes = Counter(module_of(test) for test in tests)
    times: defaultdict[str, float] = defaultdict(float)
    for test in tests:
        module = module_of(test)
        times[group_of(test)] += EXPENSIVE.get(module, UNMEASURED) / sizes[module]
    return sorted(
        range(len(tests)),
        key=lambda number: (-times[group_of(tests[number])], group_of(tests[number])),
    )


class Dealing(LoadScopeScheduling):  # type: ignore[misc]  # xdist has no types here
    """Deals out groups of tests in the order in which they were collected."""

    def _split_scope(self, nodeid: str) -> str:
        return group_of(nodeid)
