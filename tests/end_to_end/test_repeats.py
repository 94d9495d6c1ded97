"""The same scene gives the same bytes, and on other processors differs in last digits only.

Three scenes are made: one that can be written in every format, one in inches with a symmetric
keyway, and one through measured points, whose joints moved farthest with the last digits. One is
swept.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import pytest

from camgeo.app.cli.main import main
from camgeo.numeric.arrays import FloatArray
from tests.end_to_end.repeats import (
    PICTURES,
    ROOT,
    ROWS,
    SETTINGS,
    Difference,
    compared,
    content,
    differences,
    make,
    make_in_child,
    run_elsewhere,
)

SCENES = [ROOT / "fixtures" / "scenes" / f"{name}.toml" for name in ("querhub", "inch", "measured")]

SUFFIXES = {".dxf", ".ngc", ".stl", ".3mf", ".step", ".csv", ".asc", ".json", *PICTURES}

SWEEP: Final = [
    "sweep", str(ROOT / "fixtures" / "effects" / "four_bar.toml"),
    "--vary", "follower.base_radius=66:74:2",
    "--vary", "motion.2.law=polynomial-345,modified-sine",
    "--ask", "transmission-angle,peak:alpha_chi,min:mu,peak:kappa,peak:contact-force,diameter",
]  # fmt: skip
"""Designs of a four-bar with forces: some answers are computed for several at once."""


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the files made by this process."""
    folder = tmp_path_factory.mktemp("here")
    for scene in SCENES:
        make(scene, folder / scene.parent.name / scene.stem)
    return folder


def test_other_kernels_change_only_last_digits(here: Path, tmp_path: Path) -> None:
    """Neither numpy nor OpenBLAS nor the C library uses what makes this processor fast."""
    make_in_child(SCENES, tmp_path / "there", SETTINGS["all"])
    found: list[Difference] = []
    for scene in SCENES:
        folder = Path(scene.parent.name) / scene.stem
        found += differences(here / folder, tmp_path / "there" / folder)
    assert {Path(each.file).suffix for each in found} == SUFFIXES
    assert not [each for each in found if each.broken]


@pytest.mark.parametrize("suffix", sorted(SUFFIXES - {*PICTURES}))
def test_what_breaks_the_promise_is_seen(suffix: str, here: Path) -> None:
    """All coordinates are read; one that is off, or a missing or different entity, is found."""
    [file, *_] = sorted((here / "scenes" / "querhub").glob(f"*{suffix}"))
    read = content(file)
    assert len(read.numbers) > 10
    for share, broken in ((0.9, False), (1.1, True), (np.nan, True)):
        off = read.numbers.copy()
        off[7] += share * read.allowed[7]
        assert compared(file.name, read, replace(read, numbers=off)).broken == broken
    assert compared(file.name, read, replace(read, rest=read.rest[:-1])).broken
    assert compared(file.name, read, replace(read, numbers=read.numbers[:-1])).broken


def answers(file: Path) -> FloatArray:
    """(designs, questions) of a sweep."""
    designs = json.loads(file.read_text())["designs"]
    return np.array([[*each["answers"].values()] for each in designs], dtype=np.float64)


def share_apart(here: FloatArray, there: FloatArray) -> float:
    """Largest difference of two tables, as a share of the largest magnitude in the column."""
    return float(np.max(np.abs(here - there) / np.max(np.abs(here), axis=0)))


@pytest.mark.long  # the kernels are those of files; a sweep computes with no others
def test_rows_of_a_sweep_agree_on_other_processors(tmp_path: Path) -> None:
    here, there = tmp_path / "here.json", tmp_path / "there.json"
    assert main([*SWEEP, "-o", str(here)]) == 0
    run_elsewhere(["camgeo", *SWEEP, "-o", str(there)], tmp_path / "home", SETTINGS["all"])
    expected, found = answers(here), answers(there)
    assert expected.shape == (4, 6)
    assert share_apart(expected, found) <= ROWS
    for row, column in np.ndindex(expected.shape):  # one that is off is seen
        off = found.copy()
        off[row, column] += 2.0 * ROWS * np.max(np.abs(expected[:, column]))
        assert share_apart(expected, off) > ROWS
