"""`python -m tests.judges [--all]`: every judge with what it judged, as a table."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Final

from camgeo.toolpath.machine import load
from camgeo_export.interpreter.run import run
from tests.judges import bad, grbl, rs274
from tests.judges.paths import Leg, difference
from tests.judges.programs import milled_scenes, programs, random_program, workshop

RANDOM: Final = 30

Runs = Callable[[str], tuple[list[Leg], object]]


def compared(machine: str, runs: Runs, *, absolute_centres: bool) -> str:
    """What a judge of paths says of all fixture scenes and of random programs."""
    with tempfile.TemporaryDirectory() as name:
        folder = workshop(Path(name))
        texts = [
            data.decode()
            for scene in milled_scenes()
            for _, data in programs(folder, scene, machine)
        ]
    made = [
        random_program(Random(seed), 300, absolute_centres=absolute_centres)
        for seed in range(RANDOM)
    ]
    worst = [0.0, 0.0]
    for kind, each in enumerate((texts, made)):
        for text in each:
            legs, said = runs(text)
            if said:
                raise AssertionError(f"it refuses a program: {said}")
            found = run(text, load(machine), most=10_000)
            worst[kind] = max(worst[kind], difference(found, legs))
    return (
        f"{len(texts)} programs of scenes within {worst[0]:.1e} mm,"
        f" {RANDOM} random ones within {worst[1]:.1e} mm"
    )


def suite() -> str:
    """What becomes of LinuxCNC's programs that must fail."""
    paths = bad.programs()
    missed = [path.name for path in paths if not bad.found(path)]
    if missed:
        raise AssertionError(f"nothing is found in {', '.join(missed)}")
    return f"{len(paths)} of {len(paths)} programs found out"


JUDGES: Final[tuple[tuple[str, Callable[[], str], Callable[[], str]], ...]] = (
    (
        "LinuxCNC, rs274",
        rs274.absent,
        lambda: compared("linuxcnc", rs274.run, absolute_centres=True),
    ),
    ("LinuxCNC, tests/interp/bad", bad.absent, suite),
    (
        "Grbl 1.1, its parser",
        grbl.absent,
        lambda: compared("grbl", grbl.run, absolute_centres=False),
    ),
)
"""Name, why it is absent, and what it judges."""


def main(words: list[str]) -> int:
    """Print the table; 1 if a judge disagrees, or with `--all` if one is absent."""
    code = 0
    for name, absent, judge in JUDGES:
        if reason := absent():
            verdict, code = f"absent: {reason}", code or int("--all" in words)
        else:
            try:
                verdict = f"ran: {judge()}"
            except AssertionError as error:
                verdict, code = f"FAILED: {error}", 1
        sys.stdout.write(f"{name:28}{verdict}\n")
    return code


sys.exit(main(sys.argv[1:]))
