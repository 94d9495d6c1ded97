"""Imports as in a fresh interpreter, for tests of what is imported when."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def imported_anew(meant: Callable[[str], bool]) -> Iterator[None]:
    """No module whose name is `meant` has been imported; those that had been are put back.

    Also in their packages, of which a second import sets the attribute: a test that comes later
    would change a name in one copy of the module and call a function of the other.
    """
    before = {name: module for name, module in sys.modules.items() if meant(name)}
    for name in before:
        del sys.modules[name]
    try:
        yield
    finally:
        for name in [each for each in sys.modules if meant(each)]:
            del sys.modules[name]
        sys.modules.update(before)
        for name, module in before.items():
            package, _, attribute = name.rpartition(".")
            if package in sys.modules:
                setattr(sys.modules[package], attribute, module)
