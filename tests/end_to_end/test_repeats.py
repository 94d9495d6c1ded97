"""The same scene gives the same bytes, and on other processors differs in last digits only.

Three scenes: one that can be written in every format, one in inches with a symmetric keyway, and
one through measured points, whose joints moved farthest with the last digits.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.end_to_end.repeats import (
    PICTURES,
    ROOT,
    SETTINGS,
    Difference,
    compared,
    content,
    differences,
    make,
    make_in_child,
)

SCENES = [ROOT / "fixtures" / "scenes" / f"{name}.toml" for name in ("querhub", "inch", "measured")]

SUFFIXES = {".dxf", ".ngc", ".stl", ".3mf", ".step", ".csv", ".asc", ".json", *PICTURES}


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
