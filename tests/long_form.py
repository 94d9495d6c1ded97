"""The usual and the long form of the tests; `CAMGEO_LONG=1` runs all examples and sweeps."""

from __future__ import annotations

import os
from typing import Final, TypeVar

LONG: Final = os.environ.get("CAMGEO_LONG", "0") != "0"

Given = TypeVar("Given", int, float, str)


def examples(usual: Given, *, long: Given) -> Given:
    """How many examples of a property are drawn, or how many steps of a ladder are taken."""
    return long if LONG else usual
