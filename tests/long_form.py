"""The usual and the long form of the tests; `CAMGEO_LONG=1` runs all examples and sweeps."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Final, TypeVar

LONG: Final = os.environ.get("CAMGEO_LONG", "0") != "0"


Given = TypeVar("Given", int, float, str)

Item = TypeVar("Item")


def examples(usual: Given, *, long: Given) -> Given:
    """How many examples of a property are drawn, or how many steps of a ladder are taken."""
    return long if LONG else usual


def some(items: Iterable[Item], *, of: int, first: int = 0) -> list[Item]:
    """One of each `of` of the `items`, from number `first` on; all of them in the long form.

    Tests that sweep the same scenes begin at different ones, so that each scene has its share.
    """
    every = list(items)
    return every if LONG else every[first::of]
