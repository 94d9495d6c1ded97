"""How hypothesis draws: the same examples in every run, others with `--hypothesis-profile=random`.

Whoever runs the tests sees faults of the code, not rare examples that nobody can reproduce; those
have to be asked for.

Also here: which tests are quick, and how they are distributed with `-n`, so that what tests share
is made in one process only.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import Phase, find, settings
from hypothesis.internal.conjecture import providers
from hypothesis.strategies import none

from tests import thinned
from tests.long_form import LONG, examples
from tests.quick import BUILDS, BUILT, QUICK, TESTS

# Read when numpy is imported, so before any test module is. Its matrices are small here: a second
# thread hardly shortens a product and spins while it waits for the next one.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Compiled modules are kept, whatever a shell says: of the many processes that tests start, each
# would compile all of camgeo anew, and each run all tests.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# A shell's job in the background, and nohup, ignore these; so would all processes that tests start
# and stop by them.
signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

# hypothesis draws constants of all modules that the process has imported by then, so that examples
# depended on which tests ran before, and on the Python.
assert callable(providers._get_local_constants)
providers._get_local_constants = lambda: providers._local_constants

EXAMPLES: Final = examples(15, long=100)
"""Of a property that asks for no other number; 100 is hypothesis's own."""

settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=EXAMPLES)
settings.register_profile(
    "random", settings.get_profile("fixed"), derandomize=False, print_blob=True
)
# A failure is enough, the smallest example that fails is not looked for.
settings.register_profile(
    "first", settings.get_profile("fixed"), phases=(Phase.explicit, Phase.generate)
)
settings.load_profile("fixed")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """With `-m quick`, modules that have no quick tests are not imported."""
    if config.option.markexpr != "quick" or not collection_path.name.startswith("test_"):
        return None
    module = collection_path.relative_to(TESTS).as_posix()
    return True if module not in QUICK and not module.startswith(BUILDS) else None


@pytest.hookimpl(tryfirst=True)  # before marks are asked for
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the quick tests; unless tests are named one by one, leave out the cases of
    `tests.thinned` and tests of the long form; in a process of several, put them in the order of
    `tests.dealing`.
    """
    for item in items:
        call: Any = getattr(item, "callspec", None)
        built = Path(call.params["built"]).stem if call and "built" in call.params else None
        if built == BUILT or (built is None and item.path.relative_to(TESTS).as_posix() in QUICK):
            item.add_marker(pytest.mark.quick)
    if not any("::" in each for each in config.option.file_or_dir):
        # What is long goes first, so that it is not the case that is kept of a function.
        runs = [LONG or not item.get_closest_marker("long") for item in items]
        usual = [item.nodeid for item, each in zip(items, runs, strict=True) if each]
        if not thinned.WHOLE:
            kept = iter(thinned.kept(usual, thinned.EXPENSIVE))
            runs = [each and next(kept) for each in runs]
        left = [item for item, each in zip(items, runs, strict=True) if not each]
        items[:] = [item for item, each in zip(items, runs, strict=True) if each]
        config.hook.pytest_deselected(items=left)
    if hasattr(config, "workerinput"):
        from tests.dealing import longest_first

        items[:] = [items[number] for number in longest_first([item.nodeid for item in items])]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> object:
    """Groups of tests, in their order, to whichever process is free."""
    if config.getoption("dist") != "loadscope":
        return None
    from tests.dealing import Dealing

    config.option.loadscopereorder = False
    return Dealing(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """None of it is garbage, and looking for garbage would be a third of the time of collecting."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_finish() -> None:
    """What was collected lives until the end: garbage collections skip it, and are rarer."""
    # Hypothesis asks the garbage collection who refers to its generator, once, when it first draws;
    # of what is frozen Python 3.14 does not tell.
    find(none(), lambda _: True)
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000)
