"""CPU time over the number of segments, here and at another revision, in turns.

Scenes with each number of segments are made of every kind:

- "moves": rises and falls by four laws in turn, without dwells;
- "dwells": the same with a dwell before each, by one law;
- "skewed": as "moves", by one law, but each move has its own inflection point;
- "fine": segments of 360 degrees divided by their number, each with undercut, like 3,600 of 0.1
  degrees and 0.001 mm.

Each measurement is a fresh process. "findings" is the CPU time of loading a scene and all its
findings, without the import of camgeo; "check" that of the whole command `camgeo check`, with
its start and with cures. The growth is the power of the number of segments with which the time
grows from one row to the next; of a check, without that of a scene of two segments.

    python benchmarks/segments.py [--against REV] [--kinds moves,dwells,skewed,fine]
        [--sizes 100,300,1000,3000,10000] [--most 120]

What takes longer than `--most` CPU seconds is given up, and so are larger ones of the kind.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]

LAWS: Final = ("polynomial-345", "modified-sine", "cycloidal", "modified-trapezoid")

KINDS: Final = ("moves", "dwells", "skewed", "fine")

SIZES: Final = (100, 300, 1_000, 3_000, 10_000)

MILD: Final = 1.0 / 40.0
"""Stroke of a move by the base radius and the square of its span: its acceleration, six to ten
times as much, leaves the pitch curve convex."""

FINDINGS: Final = """
import sys, time
import camgeo

began = time.process_time()
assert camgeo.load(sys.argv[1]).findings
print(time.process_time() - began)
"""

Times = dict[str, float | None]


def scene(kind: str, count: int) -> str:
    """A scene of `count` segments, which is divisible by four."""
    radius = 60.0
    span = 2.0 * math.pi / count
    stroke = MILD * radius * span * span
    if kind == "fine":
        stroke = 0.001 * (3_600.0 / count) ** 2
    lines = [
        "camgeo = 1",
        f'name = "{kind}-{count}"',
        "[cam]",
        'rotation = "ccw"',
        "speed = 60",
        "[follower]",
        'kind = "translating-roller"',
        f"base_radius = {radius}",
        "roller_radius = 5.0",
    ]
    moves = 0
    for number in range(count):
        lines += ["", "[[motion]]"]
        if kind == "dwells" and number % 2 == 0:
            lines.append(f"dwell = {360.0 / count!r}")
            continue
        law = LAWS[moves % len(LAWS)] if kind == "moves" else LAWS[0]
        lines += [f'law = "{law}"', f"span = {360.0 / count!r}"]
        lines.append(f"to = {0.0 if moves % 2 else stroke!r}")
        if kind == "skewed":
            lines.append(f"inflection = {0.45 + 0.1 * number / count!r}")
        moves += 1
    return "\n".join(lines) + "\n"


def cpu(tree: Path, arguments: list[str], most: float) -> tuple[float | None, str]:
    """CPU seconds of a Python process with the camgeo of `tree`, None if it took more than `most`;
    and what it printed.
    """
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment["PYTHONPATH"] = os.pathsep.join((str(tree), str(tree / "export")))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tree, env=environment, capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(most),) * 2),
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode < 0:
        return None, ""
    if done.returncode > 1:
        raise SystemExit(done.stderr)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent, done.stdout


def measured(tree: Path, path: Path, most: float) -> Times:
    """The times of one scene [s]."""
    found, reported = cpu(tree, ["-c", FINDINGS, str(path)], most)
    check, _ = cpu(tree, ["-m", "camgeo", "check", str(path)], most)
    return {"findings": None if found is None else float(reported), "check": check}


def growth(times: Times, before: Times, name: str, ratio: float, start: float) -> str:
    """The power with which a time grew, as a cell."""
    now, then = times[name], before.get(name)
    if now is None or then is None or min(now, then) <= start:
        return f"{'':>8}"
    return f"{math.log((now - start) / (then - start)) / math.log(ratio):8.2f}"


def measure(trees: dict[str, Path], kind: str, sizes: list[int], most: float, folder: Path) -> None:
    """Print the rows of one kind."""
    path = folder / f"{kind}.toml"
    path.write_text(scene("dwells", 4), "utf-8")
    started = {name: measured(tree, path, most)["check"] or 0.0 for name, tree in trees.items()}
    last: dict[str, Times] = {name: {} for name in trees}
    smaller = 0
    for size in sizes:
        path.write_text(scene(kind, size), "utf-8")
        cells = f"{kind:<8}{size:>7,}"
        found: dict[str, Times] = {}
        for name, tree in trees.items():
            given_up = smaller and None in last[name].values()
            none: Times = {"findings": None, "check": None}
            found[name] = none if given_up else measured(tree, path, most)
        for measure_name in ("findings", "check"):
            for name in trees:
                value = found[name][measure_name]
                cells += f"{value:10.2f}" if value is not None else f"{'-':>10}"
            if "before" in trees:
                now, then = found["here"][measure_name], found["before"][measure_name]
                cells += f"{now / then:8.3f}" if now and then else f"{'':>8}"
            start = started["here"] if measure_name == "check" else 0.0
            ratio = size / smaller if smaller else 1.0
            cells += growth(found["here"], last["here"], measure_name, ratio, start)
        print(cells, flush=True)
        last, smaller = found, size


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", metavar="REV")
    parser.add_argument("--kinds", type=lambda text: text.split(","), default=[*KINDS])
    parser.add_argument(
        "--sizes", type=lambda text: [int(each) for each in text.split(",")], default=[*SIZES]
    )
    parser.add_argument("--most", type=float, default=120.0)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}; CPU s"
        + (f" here and at {arguments.against}" if arguments.against else "")
    )
    with tempfile.TemporaryDirectory() as folder:
        trees = {"here": ROOT}
        if arguments.against:
            before = Path(folder) / "before"
            subprocess.run(["git", "clone", "-q", str(ROOT), str(before)], check=True)
            subprocess.run(["git", "checkout", "-q", arguments.against], cwd=before, check=True)
            trees["before"] = before
        heads = "".join(
            f"{name:>10}" + (f"{'before':>10}{'ratio':>8}" if len(trees) > 1 else "")
            + f"{'growth':>8}"
            for name in ("findings", "check")
        )  # fmt: skip
        print(f"{'':<15}{heads}")
        for kind in arguments.kinds:
            measure(trees, kind, arguments.sizes, arguments.most, Path(folder))


if __name__ == "__main__":
    main()
