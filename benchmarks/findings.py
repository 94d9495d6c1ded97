"""CPU time of all findings of a scene, warm, here and at another revision, in turns.

Two processes, one with the camgeo of this tree and one with that of the revision, have loaded all
scenes. They are called in turns, scene by scene, in alternating order from round to round:

- "again": the findings of a fresh `Design` of a scene that was judged before;
- "varied": the same after an edit by `with_values`, which makes the base circle or the roller a
  little larger each time, as a designer does who watches the findings. The edit counts;
- "moved": the same after an edit of the motion, which makes each of its strokes a little longer, so
  that nothing known of the old plan holds for the new one;
- "curves": pitch curve with three derivatives, inner curve, transmission angle and curvature at
  30,000 angles, none of which was asked for before; no findings.

Without a scene, all fixture scenes of both trees are measured.

The medians of the rounds and of their ratios are reported, with the geometric mean of the latter
below the table. The findings are compared too: the largest difference of any value, relative to its
size, and of any cam angle, relative to a turn.


    python benchmarks/findings.py --against REV [--rounds 15] [SCENE ...]
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.units import TURN

ROOT: Final = Path(__file__).resolve().parents[1]

SCENES: Final = sorted(
    path for room in ("scenes", "effects") for path in (ROOT / "fixtures" / room).glob("*.toml")
)

WAYS: Final = ("again", "varied", "moved", "curves")

WORKER: Final = """
import json, sys, time
import camgeo
import numpy as np

scenes, edits = {}, {}

def edited(scene, way, number):
    factor = 1.0 + 1e-6 * number
    if way == "moved":
        places = enumerate(scene.values["motion"], start=1)
        ends = {f"motion[{k}].to": float(each["to"]) * factor for k, each in places if "to" in each}
        return scene.with_values(ends) if any(ends.values()) else None
    follower = scene.values["follower"]
    key = next(k for k in ("base_radius", "roller_radius", "arm") if k in follower)
    return scene.with_values({f"follower.{key}": float(follower[key]) * factor})

def evaluated(scene, number):
    disc = camgeo.Design(scene).cam.disc
    phi = np.linspace(0.0, 2.0 * np.pi, 30_000, endpoint=False) + 1e-9 * number
    curve, inner = disc.pitch_curve, disc.inner_curve
    began = time.process_time()
    curve.jet(phi), inner.point(phi), curve.transmission_angle(phi), curve.curvature(phi)
    return time.process_time() - began

for line in sys.stdin:
    path, way = json.loads(line)
    if path not in scenes:
        scenes[path] = camgeo.load(path).scene
        camgeo.Design(scenes[path]).findings
    scene = scenes[path]
    if way == "curves":
        edits[path] = edits.get(path, 0) + 1
        roller = "roller_radius" in scene.values.get("follower", {})
        took = evaluated(scene, edits[path]) if roller else None
        print(json.dumps([took, []]), flush=True)
        continue
    began = time.process_time()
    if way != "again":
        edits[path] = edits.get(path, 0) + 1
        scene = edited(scene, way, edits[path])
    found = camgeo.Design(scene).findings if scene else ()
    took = time.process_time() - began if scene else None
    reported = [(each.name, each.value, each.cam_angle) for each in found]
    print(json.dumps([took, reported]), flush=True)
"""
"""Judges the scenes named line by line on its input; prints CPU time [s] and findings."""

Told = list[tuple[str, float | None, float | None]]


class Worker:
    """A process with the camgeo of one tree."""

    def __init__(self, root: Path) -> None:
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        environment["PYTHONPATH"] = os.pathsep.join((str(root), str(root / "export")))
        self._root = root
        self._process = subprocess.Popen(
            [sys.executable, "-c", WORKER],
            cwd=root, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def ask(self, path: Path, way: str) -> tuple[float | None, Told]:
        """CPU time [s] of the findings, None if the scene has nothing to edit; and the findings."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        # A fixture scene as the tree has it, since keys change; any other scene itself.
        if path.is_relative_to(ROOT) and (self._root / path.relative_to(ROOT)).exists():
            path = self._root / path.relative_to(ROOT)
        self._process.stdin.write(json.dumps([str(path), way]) + "\n")
        self._process.stdin.flush()
        answer: Any = json.loads(self._process.stdout.readline())
        return answer[0], answer[1]

    def close(self) -> None:
        """End it."""
        self._process.communicate()


def measure(workers: dict[str, Worker], path: Path, rounds: int) -> dict[str, float]:
    """Print the row of one scene; the ratio of each way."""
    cells, ratios, differs = "", {}, 0.0
    for way in WAYS:
        times: dict[str, list[float]] = {name: [] for name in workers}
        for number in range(rounds + 1):
            reported = {}
            for name in sorted(workers, reverse=bool(number % 2)):
                took, reported[name] = workers[name].ask(path, way)
                if number and took is not None:  # the first round loads
                    times[name].append(took)
            differs = max(differs, difference(*reported.values()))
        if not times["here"]:
            cells += f"{'-':>10}{'-':>10}{'-':>8}"
            continue
        here, before = (statistics.median(times[name]) for name in ("here", "before"))
        pairs = zip(times["here"], times["before"], strict=True)
        ratios[way] = statistics.median(a / b for a, b in pairs)
        cells += f"{1e3 * here:10.2f}{1e3 * before:10.2f}{ratios[way]:8.3f}"
    print(f"{path.stem:<22}{cells}{differs:12.1e}", flush=True)
    return ratios


def difference(one: Told, other: Told) -> float:
    """By how much values differ at most, as a part of their size; cam angles of a turn."""
    if [name for name, *_ in one] != [name for name, *_ in other]:
        return math.inf
    largest = 0.0
    for (_, value, place), (_, value_then, place_then) in zip(one, other, strict=True):
        for now, then, size in ((value, value_then, 0.0), (place, place_then, TURN)):
            if (now is None) != (then is None):
                return math.inf
            if now is None or then is None or now == then:
                continue
            largest = max(largest, abs(now - then) / max(size, abs(now), abs(then)))
    return largest


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--against", metavar="REV", required=True)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()};"
        f" CPU ms here and at {arguments.against}, median of {arguments.rounds} rounds"
    )
    print(f"{'':<22}" + "".join(f"{way:>10}{'before':>10}{'ratio':>8}" for way in WAYS), end="")
    print(f"{'differs':>12}")
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        before = Path(folder) / "before"
        subprocess.run(["git", "clone", "-q", str(ROOT), str(before)], check=True)
        subprocess.run(["git", "checkout", "-q", arguments.against], cwd=before, check=True)
        workers = {"here": Worker(ROOT), "before": Worker(before)}
        for worker in workers.values():
            stack.callback(worker.close)
        both = [path for path in SCENES if (before / path.relative_to(ROOT)).exists()]
        scenes = [path.resolve() for path in arguments.scenes] or both
        found = [measure(workers, path, arguments.rounds) for path in scenes]
    means = [
        statistics.geometric_mean(ratios[way] for ratios in found if way in ratios) for way in WAYS
    ]
    print(f"{'geometric mean':<22}" + "".join(f"{mean:28.3f}" for mean in means))


if __name__ == "__main__":
    main()
