"""What a sweep costs beyond its designs: engines, store and memory, as ratios of one run.

- "engine": designs that take 10 ms without using a processor, by the loop, by one worker and by
  two: what handing out chunks costs, whatever else the machine does. Workers are started before the
  clock, as they are once for a whole run.
- "cores": designs of the Setzhub cam with another base radius, asked for the transmission angle, by
  the loop and by two workers; it says something only if two cores are idle.
- "driver": CPU time of the driver for each row that comes from an engine: points, store, answer.
- "memory": the largest memory of a process that sweeps so many designs, which cost nothing, into a
  store, and reads the rows again.

    python benchmarks/sweep.py [--rounds 3] [--designs 600] [--only engine cores driver memory]
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from camgeo.answers.sweep import answer_of
from camgeo.design import Design
from camgeo.scene.load import load_scene
from camgeo.sweep.asked import asked_of
from camgeo.sweep.engine import Chunks, Engine, Loop
from camgeo.sweep.family import Family, Point
from camgeo.sweep.pool import Pool
from camgeo.sweep.rows import Row, Work
from camgeo.sweep.stated import family_of
from camgeo.sweep.sweep import sweep

ROOT: Final = Path(__file__).resolve().parents[1]

SCENE: Final = ROOT / "fixtures" / "scenes" / "setzhub.toml"

ASK: Final = ("transmission-angle",)

PAUSE: Final = 0.010
"""Seconds of a design for "engine"."""

ROWS: Final = (1_000, 100_000)
"""Designs for "memory"."""

PARTS: Final = ("engine", "cores", "driver", "memory")


@dataclass(frozen=True)
class Pausing(Work):
    """Work whose designs take their time and nothing else."""

    def row(self, point: Point, _ledger: Any = None) -> Row:
        """After a pause."""
        time.sleep(PAUSE)
        return Row(point, (1.0,), ("deg",))


class Free:
    """An engine whose rows cost nothing."""

    name = "free"

    def rows(self, _work: Work, points: Iterator[Point]) -> Chunks:
        """In chunks of 200."""
        while chunk := tuple(islice(points, 200)):
            yield tuple(Row(point, (float(point[0]),), ("deg",)) for point in chunk)


def family(count: int) -> Family:
    """Designs with other base radii."""
    return family_of(load_scene(SCENE), [f"follower.base_radius=45:60:{count}"])


def seconds(engine: Engine, work: Work, points: list[Point]) -> float:
    """Wall time of a design after the first one, before which workers are started."""
    chunks = engine.rows(work, iter(points))
    done = len(next(chunks))
    start = time.perf_counter()
    rest = sum(len(chunk) for chunk in chunks)
    assert done + rest == len(points)
    return (time.perf_counter() - start) / rest


def compared(work: Work, points: list[Point], rounds: int) -> dict[str, float]:
    """Medians of the ratios to the loop, of rounds in alternating order."""
    engines: dict[str, Engine] = {"one worker": Pool(1), "two workers": Pool(2)}
    ratios: dict[str, list[float]] = {name: [] for name in engines}
    for _ in range(rounds):
        loop = seconds(Loop(), work, points)
        for name, engine in engines.items():
            ratios[name].append(seconds(engine, work, points) / loop)
    return {name: statistics.median(found) for name, found in ratios.items()}


def driver(count: int) -> float:
    """CPU seconds of a row."""
    designs = family(count)
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time()
        with closing(sweep(designs, ASK, store=Path(folder) / "a.sqlite", engine=Free())) as found:
            answer_of(found)
        return (time.process_time() - start) / count


def memory(count: int) -> float:
    """The largest memory of a process for so many designs [MB]."""
    words = [sys.executable, __file__, "--measure", str(count)]
    found = subprocess.run(words, capture_output=True, text=True, check=True)
    return float(found.stdout)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--designs", type=int, default=600)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--measure", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        driver(given.measure)
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return
    print(f"Python {platform.python_version()}, numpy {np.__version__}, {os.cpu_count()} cores")
    designs = family(given.designs)
    points = list(designs.points())
    work = Work.of(designs, asked_of(Design(designs.scene), ASK))
    if "engine" in given.only:
        idle = Pausing(work.text, work.contents, work.keys, work.asked, work.versions)
        for name, ratio in compared(idle, points, given.rounds).items():
            print(f"engine: {name} takes {ratio:.3f} of the loop, at 10 ms a design")
        start = time.process_time()
        seconds(Pool(2), idle, points)
        share = (time.process_time() - start) / len(points)
        print(f"engine: two workers cost the driver {1e6 * share:.0f} microseconds of CPU a design")
    if "cores" in given.only:
        for name, ratio in compared(work, points, given.rounds).items():
            print(f"cores: {name} takes {ratio:.3f} of the loop")
    if "driver" in given.only:
        print(f"driver: {1e6 * driver(20_000):.1f} microseconds of CPU a row")
    if "memory" in given.only:
        least, most = (memory(count) for count in ROWS)
        print(f"memory: {least:.0f} MB for {ROWS[0]:,} rows, {most:.0f} MB for {ROWS[1]:,}")


if __name__ == "__main__":
    main()
