"""Programs of the fixture scenes for every profile: nothing is found in them, they verify, and no
cutter is lifted before the end of its operation, unless it drills.

Six scenes, of which each profile has one and linuxcnc's is verified; in the long form all of them
for all profiles, verified, at the tolerance of the scene and at finer ones as well.
"""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from pathlib import Path
from typing import Final

import pytest

from camgeo.design.product import Product
from camgeo.errors import ToleranceError
from camgeo.milling.machine import load, names
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import Run
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import bench_of
from tests.interpreter.stated import failing
from tests.judges.programs import (
    FIXTURES,
    JOBS,
    SIX,
    TOLERANCE,
    milled_scenes,
    products,
    workshop,
)
from tests.long_form import LONG

TOLERANCES: Final = (TOLERANCE, None, 1e-4, 1e-5) if LONG else (TOLERANCE,)
"""[mm]; None is that of the scene."""

VERIFIED: Final = "linuxcnc"
"""Profile whose program is verified; `tests/end_to_end` verifies those that scenes state."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workshop(tmp_path_factory.mktemp("workshop"))


def written(product: Product, asked: float) -> tuple[bytes, float]:
    """A program and its tolerance [mm]: the one asked for, or what the machine's decimals allow."""
    try:
        return WRITER.write(product, asked).data, asked
    except ToleranceError as error:
        if "decimals" not in error.reason:
            raise
        reached = error.reached
    assert reached > asked
    return WRITER.write(product, reached).data, reached


def lifted(program: Run) -> set[str]:
    """Operations that do not make all their cuts one after the other."""
    parts = groupby(program.moves, lambda move: (move.operation, move.kind == "rapid"))
    counts = Counter(name for (name, rapid), _ in parts if not rapid)
    return {name for name, count in counts.items() if count > 1}


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(
    ("scene", "machine"),
    [
        (scene, machine)
        for k, machine in enumerate(sorted(names()))
        for scene in (milled_scenes() if LONG else [SIX[k % len(SIX)]])
    ],
)
def test_programs_are_clean_and_verify(
    scene: str, machine: str, tolerance: float | None, folder: Path
) -> None:
    profile = load(machine)
    for product in products(folder, scene, machine):
        data, kept = written(product, tolerance or product.scene.output.tolerance)
        found = run(data, profile, bench_of(product, profile))
        assert found.findings == ()
        assert lifted(found) <= {cut.name for cut in product.milled.cuts if cut.strategy == "drill"}
        if not (LONG or machine == VERIFIED):  # to measure the path takes half a second
            continue
        assert failing(product, data, kept) == []


def test_the_long_form_has_every_fixture_scene() -> None:
    """All of them state tools, and so have a program."""
    paths = [*FIXTURES.glob("*.toml"), *JOBS.glob("*.toml")]
    assert sorted(milled_scenes()) == sorted(path.stem for path in paths)
