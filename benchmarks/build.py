"""Where the time of a whole build goes, stage by stage, and what the command costs in total.

Each round is a fresh process, so the figures include imports and the first use of everything; the
median is reported. Stages run in the order in which a build needs them, so each figure is that of
its stage alone: the first writer does not pay for the outline, nor a writer for its library.

    python benchmarks/build.py [--rounds 7] [--scene fixtures/scenes/setzhub.toml]
"""

from __future__ import annotations

import argparse
import json
import os
import platform
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


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--scene", default="fixtures/scenes/setzhub.toml")
    parser.add_argument(STAGES_ONLY, type=Path, dest="report", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.report is not None:
        times = stages(arguments.scene, arguments.report.with_name("stages"))
        arguments.report.write_text(json.dumps(times), "utf-8")
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
