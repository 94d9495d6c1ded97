"""What each effect costs, relative to evaluating the motion alone; and a scene without effects.

For every effect that the scenes of `fixtures/effects` name, in one run:

- "once": the effect itself, on a design whose other quantities have already been computed, with all
  its extremes, integrals and findings; divided by the time of evaluating the motion alone, with
  three derivatives, at the 720 cam angles of a table of half degrees;
- "a point": its columns at these cam angles, divided by the same. "-" where it has none, or where
  they come from the solution that the effect itself computes.

With `--against REV`, which needs git: `camgeo check` and the engine's findings of a scene without
effects, here and at that revision, in turns in fresh interpreters. 1 is as fast as before.

    python benchmarks/effects.py [--rounds 9] [--against REV] [SCENE ...]
"""

from __future__ import annotations

import argparse
import itertools
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import numpy as np

from camgeo.design import Design
from camgeo.effects.effect import Column
from camgeo.effects.graph import Effects
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.load import load_scene
from camgeo.units import TURN

ROOT: Final = Path(__file__).resolve().parents[1]

SCENES: Final = sorted((ROOT / "fixtures" / "effects").glob("*.toml"))

POINTS: Final = 720

PLAIN: Final = "fixtures/scenes/setzhub.toml"
"""A scene without effects."""

JUDGE: Final = """
import sys, time
import camgeo
best = 1e9
for _ in range(7):
    began = time.perf_counter()
    camgeo.load(sys.argv[1]).findings
    best = min(best, time.perf_counter() - began)
print(best)
"""
"""Loads and judges a scene, warm; prints the best time [s]."""

Call = Callable[[], object]


def least(call: Call, rounds: int) -> float:
    """Least time of `call` [s]: other load on the machine only adds to it."""
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return min(times)


def measure(path: Path, rounds: int) -> None:
    """Print the table of one scene."""
    design = Design(load_scene(path))
    phi = np.linspace(0.0, TURN, POINTS, endpoint=False)
    for name in design.scene.effects:  # everything they need has been computed and imported
        design.effect(name)
    asked = shifted(phi)
    motion = least(lambda: design.cam.drive.plan.jet(next(asked)), 20 * rounds)
    print(f"\n{path.stem}: the motion alone, {POINTS} cam angles, takes {1e3 * motion:.3f} ms")
    print(f"{'':<20}{'once [ms]':>12}{'ratio':>10}{'a point, ratio':>17}")
    for name in design.scene.effects:
        once = least(lambda name=name: alone(design.effects, name), rounds)  # type: ignore[misc]  # mypy infers no type for a lambda with defaults
        columns: tuple[Column, ...] = design.effect(name).columns
        each = "-"
        if columns:
            others = shifted(phi)
            took = least(lambda c=columns, o=others: drawn(c, next(o)), rounds)  # type: ignore[misc]  # mypy infers no type for a lambda with defaults
            each = f"{took / motion / len(columns):.1f}"
        print(f"{name:<20}{1e3 * once:>12.3f}{once / motion:>10.1f}{each:>17}")


def alone(effects: Effects, name: str) -> object:
    """The effect computed anew, with the results of those that it needs."""
    return effects.recomputed(name).result(name)


def shifted(phi: FloatArray) -> Iterator[FloatArray]:
    """The cam angles `phi` (n,), moved a little each time: nothing is recalled from before."""
    for number in itertools.count(1):
        yield phi + 1e-9 * number


def drawn(columns: tuple[Column, ...], phi: FloatArray) -> None:
    """All columns at `phi` (n,) [rad]."""
    for column in columns:
        column.values(phi, "right")


def compare(revision: str, rounds: int) -> None:
    """Print how long a scene without effects takes here, by how long it took at `revision`."""
    with tempfile.TemporaryDirectory() as folder:
        before = Path(folder) / "before"
        subprocess.run(["git", "clone", "-q", str(ROOT), str(before)], check=True)
        subprocess.run(["git", "checkout", "-q", revision], cwd=before, check=True)
        warm: dict[str, list[float]] = {"here": [], "before": []}
        check: dict[str, list[float]] = {"here": [], "before": []}
        for number in range(rounds + 1):
            for name, root in (("here", ROOT), ("before", before)):
                inside = float(output(root, "-c", JUDGE, PLAIN))
                began = time.perf_counter()
                output(root, "-m", "camgeo", "check", PLAIN)
                took = time.perf_counter() - began
                if number:  # the first round compiles
                    warm[name].append(inside)
                    check[name].append(took)
    for what, times in (("findings, warm", warm), ("camgeo check, fresh", check)):
        here, past = min(times["here"]), min(times["before"])
        ratios = [a / b for a, b in zip(times["here"], times["before"], strict=True)]
        print(
            f"{what:<22}{1e3 * here:8.1f} ms here, {1e3 * past:8.1f} ms at {revision}: ratio"
            f" {here / past:.3f} of the least, {statistics.median(ratios):.3f} median of the rounds"
        )


def output(root: Path, *arguments: str) -> str:
    """The output of an interpreter with the camgeo in the folder `root`."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPATH"] = os.pathsep.join((str(root), str(root / "export")))
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=root, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode not in {0, 1} or "Traceback" in done.stderr:
        raise SystemExit(done.stderr)
    return done.stdout


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", type=Path, default=SCENES)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--against", metavar="REV")
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()},"
        f" least of {arguments.rounds} rounds"
    )
    if arguments.against:
        compare(arguments.against, arguments.rounds)
        return
    for path in arguments.scenes:
        measure(path, arguments.rounds)


if __name__ == "__main__":
    main()
