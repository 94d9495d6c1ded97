"""What other interpreters say of our programs, where they are installed.

`python -m tests.judges` shows which ran; here those that are absent are skipped with a word.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from camgeo.toolpath.machine import load
from camgeo_export.interpreter.run import run
from tests.judges import bad, grbl, rs274
from tests.judges.paths import difference
from tests.judges.programs import (
    SIX,
    milled_scenes,
    programs,
    random_contour,
    random_program,
    workshop,
)
from tests.long_form import LONG, examples

NEAR = 1e-4
"""How far another interpreter's path may be from ours [mm]; Grbl computes in single precision."""

linuxcnc = pytest.mark.skipif(bool(rs274.absent()), reason=rs274.absent() or "is there")
grbl_parser = pytest.mark.skipif(bool(grbl.absent()), reason=grbl.absent() or "is there")
suite = pytest.mark.skipif(bool(bad.absent()), reason=bad.absent() or "is there")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workshop(tmp_path_factory.mktemp("workshop"))


@linuxcnc
@pytest.mark.parametrize("scene", milled_scenes() if LONG else SIX)
def test_linuxcnc_runs_the_same_path(scene: str, folder: Path) -> None:
    for _, data in programs(folder, scene, "linuxcnc"):
        text = data.decode()
        legs, said = rs274.run(text)
        assert said == ""
        assert difference(run(text, load("linuxcnc")), legs) <= NEAR


@linuxcnc
@pytest.mark.parametrize("seed", range(examples(3, long=30)))
def test_linuxcnc_understands_random_programs_as_we_do(seed: int) -> None:
    text = random_program(Random(seed), 300, absolute_centres=True)
    legs, said = rs274.run(text)
    assert said == ""
    assert len(legs) > 150
    assert difference(run(text, load("linuxcnc"), most=10_000), legs) <= 1e-9


@linuxcnc
@pytest.mark.parametrize("first", range(0, examples(20, long=300), 10))
def test_what_linuxcnc_refuses_under_compensation_is_found(first: int) -> None:
    """We also find moves that it would shorten to nothing behind the last corner."""
    stricter = 0
    for seed in range(first, first + 10):
        text = random_contour(Random(seed))
        _, said = rs274.run(text)
        found = {each.rule for each in run(text, load("linuxcnc")).findings}
        ours = bool(found & {"gouge", "compensation"})
        assert ours or not said, (seed, said)
        stricter += ours and not said
    assert stricter <= 2


@grbl_parser
@pytest.mark.parametrize("scene", milled_scenes() if LONG else SIX)
def test_grbl_runs_the_same_path(scene: str, folder: Path) -> None:
    for _, data in programs(folder, scene, "grbl"):
        text = data.decode()
        legs, errors = grbl.run(text)
        assert errors == []
        assert difference(run(text, load("grbl")), legs) <= NEAR


@grbl_parser
@pytest.mark.parametrize("seed", range(examples(3, long=30)))
def test_grbl_understands_random_programs_as_we_do(seed: int) -> None:
    text = random_program(Random(seed), 300, absolute_centres=False)
    legs, errors = grbl.run(text)
    assert errors == []
    # Centres of arcs by their radius move by more than the ends that single precision rounds.
    assert difference(run(text, load("grbl"), most=10_000), legs) <= 2e-3


@suite
def test_programs_that_must_fail_do() -> None:
    assert len(bad.programs()) >= 20
    assert [path.name for path in bad.programs() if not bad.found(path)] == []


def test_a_path_that_differs_is_told() -> None:
    """The comparison itself."""
    from tests.judges.paths import Leg

    found = run("G21 G0 Z5\nG0 X1 Y2\nG2 X3 Y2 I1 J0 F1\nM2\n", load("linuxcnc"))
    legs = [
        Leg(1, "rapid", (0.0, 0.0, 5.0)),
        Leg(2, "rapid", (1.0, 2.0, 5.0)),
        Leg(3, "arc", (3.0, 2.0, 5.0), 2 + 2j, -1),
    ]
    assert difference(found, legs) == 0.0
    assert difference(found, [*legs[:2], Leg(3, "arc", (3.0, 2.1, 5.0), 2 + 2j, -1)]) >= 0.09
    for wrong in ([*legs, legs[0]], legs[:2], [*legs[:2], Leg(3, "arc", legs[2].end, 2 + 2j, 1)]):
        with pytest.raises(AssertionError):
            difference(found, wrong)
