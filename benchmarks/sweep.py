"""What a sweep costs beyond its designs: engines, store and memory, as ratios of one run.

- "batch": designs with another base radius or coupler, one by one and many at once, in CPU time:
  rows, with their scenes and without, and curves and angles at 361 angles.
- "engine": designs that take 10 ms without using a processor, by the loop, by one worker and by
  two: what handing out chunks costs, whatever else the machine does; under 5% over is wanted.
  Workers are started before the clock, as they are once for a whole run.
- "cores": designs of the Setzhub cam with another base radius, asked for the transmission angle, by
  the loop and by two workers, which should be 1.7 times as fast; it says something only if two
  cores are idle.
- "cluster": the same designs of 10 ms by two workers of a Dask scheduler, and designs that cost
  nothing, alone and in chunks: CPU time of driver and scheduler for each chunk, which says how many
  chunks a second a cluster can have; under 5% over is wanted. Only where asked for; needs
  camgeo[cluster].
- "driver": CPU time of the driver for each row that comes from an engine: points, store, answer.
- "memory": the largest memory of a process that sweeps so many designs, which cost nothing, into a
  store, and reads the rows again; the same for 1,000 and 100,000 is wanted.

    python benchmarks/sweep.py [--rounds 3] [--designs 600]
        [--only batch engine cores driver memory cluster]
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from dataclasses import dataclass
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, Final

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from camgeo.app.answers.sweep import answer_of
from camgeo.cam.cam import Disc
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.studies.sweep import rows
from camgeo.studies.sweep.cluster import Cluster
from camgeo.studies.sweep.family import Family, Point, family_of
from camgeo.studies.sweep.pool import Pool
from camgeo.studies.sweep.rows import (
    Chunks,
    DesignRow,
    Engine,
    Loop,
    Work,
    compute_rows,
    discs_together,
    parse_questions,
)
from camgeo.studies.sweep.sweep import sweep
from camgeo.units import TURN

ROOT: Final = Path(__file__).resolve().parents[1]

SCENE: Final = ROOT / "fixtures" / "scenes" / "setzhub.toml"

ASK: Final = ("transmission-angle",)

PAUSE: Final = 0.010
"""Seconds of a design for "engine"."""

ROWS: Final = (1_000, 100_000)
"""Designs for "memory"."""

ONE: Final = ("transmission-angle", "min:mu", "peak:kappa")

THREE: Final = ",".join(ONE)

RADIUS: Final = "follower.base_radius"

BATCHES: Final = {
    ("setzhub", RADIUS): (*ONE, "peak:inner-x", "peak:a", THREE),
    ("setzhub", "linkage.coupler"): (*ONE, "peak:psi"),
    ("tappet", RADIUS): ("min:mu", "peak:kappa"),
}
"""Scenes, what varies, and what is asked for "batch": a lever behind a linkage and a flat face on a
guide."""

ANGLES: Final = 361

DISCS: Final = 64
"""Designs whose curves are evaluated at once."""

PARTS: Final = ("batch", "engine", "cores", "driver", "memory")

OTHERS: Final = ("cluster",)


@dataclass(frozen=True)
class Pausing(Work):
    """Work whose designs take their time and nothing else."""

    def rows(self, points: Sequence[Point], _ledger: Any = None) -> list[DesignRow]:
        """After a pause for each."""
        time.sleep(PAUSE * len(points))
        return [DesignRow(point, (1.0,), ("deg",)) for point in points]


@dataclass(frozen=True)
class Idle(Work):
    """Work whose designs cost nothing."""

    def rows(self, points: Sequence[Point], _ledger: Any = None) -> list[DesignRow]:
        """At once."""
        return [DesignRow(point, (1.0,), ("deg",)) for point in points]


class Free:
    """An engine whose rows cost nothing."""

    name = "free"

    def rows(self, _work: Work, points: Iterator[Point]) -> Chunks:
        """In chunks of 200."""
        while chunk := tuple(islice(points, 200)):
            yield tuple(DesignRow(point, (float(point[0]),), ("deg",)) for point in chunk)

    def held(self) -> AbstractContextManager[None]:
        """It has no workers."""
        return nullcontext()


def family(count: int) -> Family:
    """Designs with other base radii."""
    return family_of(load_scene(SCENE), [f"follower.base_radius=45:60:{count}"])


def cpu(call: Callable[[], object]) -> float:
    """CPU seconds of a call."""
    start = time.process_time()
    call()
    return time.process_time() - start


def batch(scene: str, key: str, ask: str, count: int, rounds: int) -> None:
    """Rows one by one and many at once, in alternating order, and print."""
    base = load_scene(ROOT / "fixtures" / "scenes" / f"{scene}.toml")
    body, name = key.split(".")
    least = float(base.values[body][name])
    varied = family_of(base, [f"{key}={least}:{1.2 * least}:{count}"])
    work = Work.for_family(varied, parse_questions(Design(base), ask.split(",")))
    points = list(varied.points())
    found = []
    for _ in range(rounds):
        alone = cpu(lambda: [work.rows([point]) for point in points])
        together = cpu(lambda: compute_rows(work, points))
        scenes = cpu(lambda: [work.design_scene(point) for point in points])
        found.append((alone, together, scenes, alone / together))
    alone, together, scenes, ratio = (statistics.median(each) for each in zip(*found, strict=True))
    rest = statistics.median((a - s) / (t - s) for a, t, s, _ in found)
    each = 1e3 / count
    print(
        f"batch: {scene}, {key}, {ask}: {each * alone:.2f} ms alone, {each * together:.2f}"
        f" together, of which {each * scenes:.2f} for the scene; {ratio:.1f} times, without scenes"
        f" {rest:.1f}"
    )


def discs_of(count: int, *, own: bool) -> list[Disc]:
    """Designs with other base radii; each with an `own` motion, or all with the same."""
    base = load_scene(SCENE)
    return [
        Design(
            (load_scene(SCENE) if own else base).with_values({"follower.base_radius": radius})
        ).cam.disc
        for radius in np.linspace(45.0, 60.0, count).tolist()
    ]


def curves(count: int, rounds: int) -> None:
    """Curves and angles at 361 angles, one design after the other and all at once; print.

    One after the other also with a motion for each design, which is otherwise recalled.
    """
    phi = np.linspace(0.0, TURN, ANGLES)
    quantities: dict[str, Callable[[Disc], Any]] = {
        "pitch curve": lambda disc: disc.pitch_curve.point,
        "inner curve": lambda disc: disc.inner_curve.point,
        "curvature": lambda disc: disc.pitch_curve.curvature,
        "transmission angle": lambda disc: disc.pitch_curve.transmission_angle,
    }
    for name, quantity in quantities.items():
        found = []
        for _ in range(rounds):
            many = discs_together(discs_of(count, own=False))
            groups = discs_of(count, own=True), list(many.members)
            own, alone = (
                cpu(lambda each=each, of=quantity: [of(disc)(phi, "right") for disc in each])  # type: ignore[misc]  # mypy infers no type for a lambda with defaults
                for each in groups
            )
            together = cpu(lambda many=many, of=quantity: many.everywhere(of, phi, "right"))  # type: ignore[misc]  # likewise
            found.append((own, alone, together, own / together, alone / together))
        *taken, whole, part = (statistics.median(each) for each in zip(*found, strict=True))
        each_takes = [f"{1e6 * each / count:.0f}" for each in taken]
        print(
            f"batch: {name} at {ANGLES} angles: {each_takes[0]} microseconds alone, {each_takes[1]}"
            f" with the motion at hand, {each_takes[2]} together; {whole:.1f} and {part:.1f} times"
        )


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
        for name, each in engines.items():
            ratios[name].append(seconds(each, work, points) / loop)
    return {name: statistics.median(found) for name, found in ratios.items()}


@contextmanager
def cluster() -> Iterator[tuple[str, int]]:
    """A scheduler with two workers on loopback: its address, and its process."""
    local = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    dask = [sys.executable, "-m", "dask"]
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        words = ["scheduler", "--port", "0", "--scheduler-file", str(file), *local]
        started = [subprocess.Popen([*dask, *words], cwd=ROOT, **quiet)]
        try:
            while not file.exists() or not file.read_text().endswith("}"):
                time.sleep(0.05)
            address = json.loads(file.read_text())["address"]
            words = ["worker", address, "--nthreads", "1", "--no-nanny", "--local-directory"]
            place = {**os.environ, "PYTHONPATH": str(ROOT)}
            for _ in range(2):
                command = [*dask, *words, folder, *local]
                started.append(subprocess.Popen(command, cwd=ROOT, env=place, **quiet))
            yield address, started[0].pid
        finally:
            for each in started:  # nothing of theirs is to be kept
                each.kill()
            for each in started:
                each.wait()


def clustered(work: Work, points: list[Point], rounds: int) -> None:
    """Measure a cluster, and print."""
    import psutil
    from distributed import Client

    sys.path.insert(0, str(ROOT))  # workers import what they do by this name
    here = import_module("benchmarks.sweep")
    idle, free = (
        kind(work.text, work.contents, work.keys, work.questions, work.versions)
        for kind in (here.Pausing, here.Idle)
    )
    with cluster() as (address, pid):
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(2)
        used = Cluster(address)
        ratios = []
        for _ in range(rounds):
            ratios.append(seconds(used, idle, points) / seconds(Loop(), idle, points))
        ratio = statistics.median(ratios)
        print(f"cluster: two workers {shares(ratio, 2)}")
        process = psutil.Process(pid)
        for size in (1, 50):
            vars(rows)["MOST_IN_CHUNK"] = size
            count = 400 * size
            many: list[Point] = [(float(k),) for k in range(count)]
            before, start = sum(process.cpu_times()[:2]), time.process_time()
            clock = seconds(used, free, many)
            driver, scheduler = (
                1e3 * (after - was) / count * size
                for after, was in (
                    (time.process_time(), start),
                    (sum(process.cpu_times()[:2]), before),
                )
            )
            print(
                f"cluster: {1e3 * clock:.3f} ms a design that costs nothing, in chunks of {size};"
                f" CPU of a chunk: {driver:.2f} ms of the driver, {scheduler:.2f} of the scheduler"
            )


def shares(ratio: float, workers: int) -> str:
    """What so many workers take of designs that take 10 ms, in words."""
    beyond = 100.0 * (workers * ratio - 1.0)
    verb = "takes" if workers == 1 else "take"
    return f"{verb} {ratio:.3f} of the loop at 10 ms a design, {beyond:.1f}% over"


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
    parser.add_argument("--only", nargs="+", choices=PARTS + OTHERS, default=PARTS)
    parser.add_argument("--measure", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        driver(given.measure)
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return
    print(f"Python {platform.python_version()}, numpy {np.__version__}, {os.cpu_count()} cores")
    designs = family(given.designs)
    points = list(designs.points())
    work = Work.for_family(designs, parse_questions(Design(designs.scene), ASK))
    if "batch" in given.only:
        for (scene, key), asks in BATCHES.items():
            for ask in asks:
                batch(scene, key, ask, given.designs, given.rounds)
        curves(DISCS, given.rounds)
    if "engine" in given.only:
        idle = Pausing(work.text, work.contents, work.keys, work.questions, work.versions)
        ratios = compared(idle, points, given.rounds).items()
        for count, (name, ratio) in enumerate(ratios, start=1):
            print(f"engine: {name} {shares(ratio, count)}")
        start = time.process_time()
        seconds(Pool(2), idle, points)
        share = (time.process_time() - start) / len(points)
        print(f"engine: two workers cost the driver {1e6 * share:.0f} microseconds of CPU a design")
    if "cores" in given.only:
        for name, ratio in compared(work, points, given.rounds).items():
            print(f"cores: {name}, {ratio:.3f} of the loop: {1.0 / ratio:.2f} times as fast")
    if "cluster" in given.only:
        clustered(work, points, given.rounds)
    if "driver" in given.only:
        print(f"driver: {1e6 * driver(20_000):.1f} microseconds of CPU a row")
    if "memory" in given.only:
        least, most = (memory(count) for count in ROWS)
        print(
            f"memory: {least:.0f} MB for {ROWS[0]:,} rows, {most:.0f} MB for {ROWS[1]:,}:"
            f" {most / least:.2f} times as much"
        )


if __name__ == "__main__":
    main()
