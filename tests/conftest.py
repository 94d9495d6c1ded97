"""How hypothesis draws: the same examples in every run, others with `--hypothesis-profile=random`.

A reader who runs the tests is told of faults of the code, not of a rare example that no one else
can see again; whoever hunts for such examples asks for them.

And how the tests are dealt out with `-n`: what is shared is made in one process alone.
"""

from __future__ import annotations

import gc

import pytest
from hypothesis import settings

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile("random", derandomize=False, deadline=None, print_blob=True)
settings.load_profile("fixed")


@pytest.hookimpl(tryfirst=True)  # before the groups are read
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Group tests as their module says, by the scene that is built for them, or by their module."""
    for item in items:
        if item.get_closest_marker("xdist_group") is not None:
            continue
        shared = getattr(item, "callspec", None)
        built = shared.params.get("built") if shared is not None else None
        group = item.location[0] if built is None else f"built {built.stem}"
        item.add_marker(pytest.mark.xdist_group(group))


def pytest_collection_finish() -> None:
    """What was collected lives until the end: no collection of garbage looks through it again."""
    gc.collect()
    gc.freeze()
