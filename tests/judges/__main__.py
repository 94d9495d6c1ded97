"""`python -m tests.judges [--all]`: every judge with what it judged, as a table."""

from __future__ import annotations

import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from random import Random
from typing import Final

import camgeo
from camgeo.milling.machine import load
from camgeo_export.interpreter.run import run
from tests.judges import bad, cad, chromium, chromium_designer, grbl, grbl_planner, node, rs274
from tests.judges.files import (
    SIX,
    Given,
    files,
    milled_scenes,
    programs,
    random_program,
    reports,
    scene_of,
    scenes,
    sheets,
    workshop,
)
from tests.judges.paths import Leg, difference


@dataclass(frozen=True)
class Extent:
    """How much is judged: six scenes and some random programs, with `--all` all there is; among the
    tests `few`, one scene for each kind of file.
    """

    everything: bool = False
    few: bool = False

    @property
    def milled(self) -> list[str]:
        return milled_scenes() if self.everything else list(SIX)

    @property
    def random(self) -> int:
        return 30 if self.everything else 2 if self.few else 10

    def with_a(self, kind: str) -> list[str]:
        return scenes(kind) if self.everything else self.shown

    @property
    def shown(self) -> list[str]:
        return list(SIX[:1]) if self.few and not self.everything else self.milled


Runs = Callable[[str], tuple[list[Leg], object]]

NEAR: Final = 1e-4
"""How far another interpreter's path may be from ours [mm]; Grbl computes in single precision."""


def compared(machine: str, runs: Runs, near: float, extent: Extent) -> str:
    """What a judge of paths says of programs of scenes and of random ones, which are to be `near`
    [mm]; of arcs by their radius single precision moves centres more than ends.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = workshop(Path(name))
        texts = [
            data.decode() for scene in extent.milled for _, data in programs(folder, scene, machine)
        ]
    absolute = machine != "grbl"
    made = [
        random_program(Random(seed), 300, absolute_centres=absolute)
        for seed in range(extent.random)
    ]
    worst = []
    for each, most in ((texts, NEAR), (made, near)):
        apart = []
        for text in each:
            legs, said = runs(text)
            if said:
                raise AssertionError(f"it refuses a program: {said}")
            apart.append(difference(run(text, load(machine), most=10_000), legs))
        worst.append(max(apart))
        if worst[-1] > most:
            raise AssertionError(f"a program runs {worst[-1]:.1e} mm off")
    return (
        f"{len(texts)} programs of scenes within {worst[0]:.1e} mm,"
        f" {extent.random} random ones within {worst[1]:.1e} mm"
    )


def suite(extent: Extent) -> str:
    """What becomes of LinuxCNC's programs that must fail."""
    paths = bad.programs()
    missed = [path.name for path in paths if not bad.found(path)]
    if missed or len(paths) < 20:
        raise AssertionError(f"nothing is found in {', '.join(missed)} of {len(paths)}")
    return f"{len(paths)} of {len(paths)} programs found out"


def read(judge: Callable[[Given], float], kinds: dict[str, str], extent: Extent) -> str:
    """What a judge of files says of those of scenes; `kinds` has the unit of what it compares."""
    told = []
    for kind, unit in kinds.items():
        apart: dict[float, list[float]] = defaultdict(list)  # by how near they must be
        with tempfile.TemporaryDirectory() as name:
            for given in files(Path(name), kind, extent.with_a(kind)):
                apart[given.near].append(judge(given))
        told += [
            f"{len(each)} {kind.upper()} files within {max(each):.1e}{unit}"
            for each in apart.values()
        ]
    return ", ".join(told)


def timed(extent: Extent) -> str:
    """What Grbl's planner says of machining times."""
    apart = [grbl_planner.judge(camgeo.load(scene_of(name))) for name in extent.milled]
    return f"times of operations of {len(apart)} scenes within {max(apart):.1e}"


def shown(extent: Extent) -> str:
    """What becomes of the setup sheets and reports."""
    with tempfile.TemporaryDirectory() as name:
        for page in sheets(Path(name), extent.shown):
            chromium.judge(page)
        for page in reports(Path(name), extent.shown):
            chromium.judge_report(page)
    return f"{len(extent.shown)} setup sheets and reports shown"


SIZE, VOLUME = " mm of their size", " of their volume"

WALLS = " mm along their walls"

JUDGES: Final[dict[str, tuple[Callable[[], str], Callable[[Extent], str]]]] = {
    "LinuxCNC, rs274": (rs274.absent, partial(compared, "linuxcnc", rs274.run, 1e-9)),
    "LinuxCNC, tests/interp/bad": (bad.absent, suite),
    "Grbl 1.1, its parser": (grbl.PARSER.absent, partial(compared, "grbl", grbl.run, 2e-3)),
    "Grbl 1.1, its planner": (grbl_planner.PLANNER.absent, timed),
    "FreeCAD": (
        cad.FREECAD.absent,
        partial(read, cad.judged_by_freecad, {"dxf": SIZE, "stl": VOLUME, "step": VOLUME}),
    ),
    "OpenCASCADE": (cad.occ_missing, partial(read, cad.judged_by_occ, {"step": VOLUME})),
    "LibreCAD": (cad.LIBRECAD.absent, partial(read, cad.judged_by_librecad, {"dxf": SIZE})),
    "PrusaSlicer": (
        cad.SLICER.absent,
        partial(read, cad.judged_by_slicer, {"stl": VOLUME, "3mf": VOLUME}),
    ),
    "PrusaSlicer, its perimeters": (
        cad.SLICER.absent,
        partial(read, cad.slice_, {"stl": WALLS, "3mf": WALLS}),
    ),
    "lib3mf": (cad.lib3mf_missing, partial(read, cad.judged_by_lib3mf, {"3mf": VOLUME})),
    "Chromium": (chromium.CHROMIUM.absent, shown),
    "Chromium, the designer": (
        chromium_designer.missing,
        lambda extent: chromium_designer.judge(everything=extent.everything),
    ),
    "node, TypeScript": (
        node.missing,
        lambda _: f"{node.judge()} bundles checked and made anew, the same bytes",
    ),
}
"""By name why it is absent, and what it judges."""


def main(words: list[str]) -> int:
    """Print the table; 1 if a judge disagrees, or with `--all` if one is absent."""
    everything = "--all" in words
    code = 0
    for name, (absent, judge) in JUDGES.items():
        if reason := absent():
            verdict, code = f"absent: {reason}", code or int(everything)
        else:
            try:
                verdict = f"ran: {judge(Extent(everything))}"
            except AssertionError as error:
                verdict, code = f"FAILED: {error}", 1
        sys.stdout.write(f"{name:29}{verdict}\n")
        sys.stdout.flush()
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
