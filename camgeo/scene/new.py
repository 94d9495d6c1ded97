"""Commented scenes to start from, for `camgeo new KIND`."""

from __future__ import annotations

import pathlib
from typing import Final

TEMPLATES: Final = pathlib.Path(__file__).with_name("templates")

KINDS: Final = (
    "translating-roller",
    "oscillating-roller",
    "knife-edge",
    "translating-flat",
    "oscillating-flat",
    "groove",
    "conjugate-carriage",
    "conjugate-lever",
    "constant-breadth",
    "slider-crank",
    "crank-slider",
    "four-bar",
)
"""What `template` has a scene for; the first is the default of the command line."""


def template(kind: str) -> str:
    """Return the text of a commented scene of that kind; KeyError if there is none."""
    if kind not in KINDS:
        raise KeyError(kind)
    return (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
