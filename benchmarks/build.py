"""Where the time of a whole build goes, stage by stage, and what the command costs in total.

Each round is a fresh process, so the figures include imports and the first use of everything; the
median is reported. Stages run in the order in which a build needs them, so each figure is that of
its stage alone: the first writer does not pay for the outline, nor a writer for its library.

With `--against REV`, which needs git: the CPU time of the whole command in all formats, here and
at that revision, in turns, each in a fresh process.

    python benchmarks/build.py [--rounds 7] [--scene fixtures/scenes/setzhub.toml] [--against REV]
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
from pathlib import Path
from typing import Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]

ENVIRONMENT: Final = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
"""Compiled modules are kept between runs, as for any user of the program."""

STAGES_ONLY: Final = "--stages-into"
"""Option that runs the stages once in this process, which the benchmark starts for each round."""

FORMATS: Final = "dxf,gcode,stl,3mf,csv,svg,png,asc"

COMMAND: Final = "camgeo build, whole command"


def stages(scene: str, folder: Path) -> dict[str, float]:
    """Build `scene` into `folder` and return the seconds of each stage."""
    times: dict[str, float] = {}
    began = time.perf_counter()

    def mark(stage: str) -> None:
        nonlocal began
        now = time.perf_counter()
        times[stage] = times.get(stage, 0.0) + now - began
        began = now

    import camgeo

    mark("import camgeo (numpy is loaded)")
    design = camgeo.load(scene)
    mark("load the scene")
    assert design.findings
    mark("findings")
    assert design.disc.drawn.part.boundaries
    mark("part: outline and bore")

    from camgeo.design.writing import find_writer, write_files

    output = design.scene.output
    for name in output.formats:
        find_writer(name)
        mark(f"{name}: import the writer")

    doing = ""

    def progress(step: str) -> None:
        nonlocal doing
        if doing:
            mark(doing)
        doing = step

    write_files(design.discs, folder, output.formats, output.tolerance, progress=progress)
    mark(f"{doing}; certificate, all files onto the disk")
    return times


def one_round(scene: str) -> dict[str, float]:
    """Stages of a build in a fresh process, and the command in another [s]."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        script = [sys.executable, __file__, "--scene", scene, STAGES_ONLY, str(report)]
        subprocess.run(script, cwd=ROOT, env=ENVIRONMENT, check=True)
        times: dict[str, float] = json.loads(report.read_text("utf-8"))
        command = [sys.executable, "-m", "camgeo", "build", scene, "-o", f"{folder}/whole"]
        began = time.perf_counter()
        done = subprocess.run(
            command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, check=False
        )
        times[COMMAND] = time.perf_counter() - began
        if not (Path(folder) / "whole" / "certificate.json").exists():
            raise SystemExit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
        return times


def cpu(tree: Path, scene: str, out: Path) -> float:
    """CPU time [s] of `camgeo build` in all formats by the camgeo of `tree`, in a fresh process."""

    def spent() -> float:
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    out.parent.mkdir(exist_ok=True)  # without another camgeo, which Python would import first
    words = ["build", scene, "-o", str(out), "--force", "--only", FORMATS]
    began = spent()
    done = subprocess.run(
        [sys.executable, "-m", "camgeo", *words],
        env=ENVIRONMENT | {"PYTHONPATH": os.pathsep.join(map(str, (tree, tree / "export")))},
        cwd=out.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    took = spent() - began
    if not (out / "certificate.json").exists() or "Traceback" in done.stderr:
        raise SystemExit(f"camgeo {' '.join(words)}: exit {done.returncode}\n{done.stderr}")
    return took


def compare(scene: str, revision: str, rounds: int) -> None:
    """Print the CPU time of the command here and at the revision, and their ratio."""
    times: dict[str, list[float]] = {"here": [], revision: []}
    with tempfile.TemporaryDirectory() as folder:
        before = Path(folder) / "tree"
        subprocess.run(["git", "clone", "-q", str(ROOT), str(before)], check=True)
        subprocess.run(["git", "checkout", "-q", revision], cwd=before, check=True)
        trees = {"here": ROOT, revision: before}
        for number in range(rounds + 1):
            for name in sorted(trees, reverse=bool(number % 2)):
                own = _own(scene, trees[name])
                took = cpu(trees[name], str(own), Path(folder) / name / "out")
                if number:  # the first round fills the caches of bytecode and of the disk
                    times[name].append(took)
    print(f"CPU of `camgeo build` in all formats, median and least of {rounds} rounds")
    for name, found in times.items():
        print(f"{name:<12}{1e3 * statistics.median(found):>8.0f} ms{1e3 * min(found):>8.0f} ms")
    ratios = [here / there for here, there in zip(*times.values(), strict=True)]
    print(f"{'ratio':<12}{statistics.median(ratios):>8.3f}, {min(ratios):.3f} to {max(ratios):.3f}")


def _own(scene: str, tree: Path) -> Path:
    """The fixture scene as `tree` has it, since keys change; any other scene itself."""
    path = Path(scene)
    if path.is_relative_to(ROOT) and (tree / path.relative_to(ROOT)).exists():
        return tree / path.relative_to(ROOT)
    return path


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--scene", default="fixtures/scenes/setzhub.toml")
    parser.add_argument("--against", metavar="REV")
    parser.add_argument(STAGES_ONLY, type=Path, dest="report", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.report is not None:
        times = stages(arguments.scene, arguments.report.with_name("stages"))
        arguments.report.write_text(json.dumps(times), "utf-8")
        return

    if arguments.against:
        compare(str(Path(arguments.scene).resolve()), arguments.against, arguments.rounds)
        return

    one_round(arguments.scene)  # fills the caches of bytecode and of the disk
    rounds = [one_round(arguments.scene) for _ in range(arguments.rounds)]
    median = {stage: statistics.median(times[stage] for times in rounds) for stage in rounds[0]}
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()},"
        f" median of {arguments.rounds} rounds, {arguments.scene}\n"
    )
    whole = median.pop(COMMAND)
    width = max(len(stage) for stage in median)
    for stage, took in median.items():
        print(f"{stage:<{width}}{1e3 * took:>10.1f} ms")
    print(f"{'all stages':<{width}}{1e3 * sum(median.values()):>10.1f} ms")
    print(f"{COMMAND:<{width}}{1e3 * whole:>10.1f} ms")


if __name__ == "__main__":
    main()
