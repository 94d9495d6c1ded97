"""The scenes that the designer's tests run through: all of fixtures, and the templates."""

from __future__ import annotations

import functools
import pathlib
from typing import Any

from camgeo.app.designing.children import Job
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.scene.toml import TEMPLATES
from tests.long_form import LONG

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"
FOLDERS = (FIXTURES / "scenes", FIXTURES / "effects", FIXTURES / "pairs", TEMPLATES)
FILES = [path for folder in FOLDERS for path in sorted(folder.glob("*.toml"))]


SETZHUB = FIXTURES / "scenes" / "setzhub.toml"
TEXT = SETZHUB.read_text("utf-8")
"""A rocker behind a linkage, and its text."""


def name_of(file: pathlib.Path) -> str:
    """What tests call a file."""
    return f"{file.parent.name}-{file.stem}"


KINDS = frozenset(
    ["scenes-inch", "scenes-groove", "scenes-conjugate_lever", "scenes-crank_slider",
     "scenes-flat_rocker", "scenes-points", "scenes-measured", "scenes-hub_and_holes",
     "effects-yoke", "effects-four_bar", "pairs-conjugate_pair", "templates-milled"]
)  # fmt: skip
CHOSEN = [file for file in FILES if LONG or name_of(file) in KINDS]
"""Files of each kind; all of them in the long form."""


@functools.cache
def design(file: pathlib.Path) -> Design:
    """The design of a file, made once."""
    return Design(load_scene(file))


def job(kind: str, file: pathlib.Path, **arguments: Any) -> Job:
    """A job on the scene of a file."""
    return Job(kind, file.read_text("utf-8"), str(file), str(file.parent), arguments)
