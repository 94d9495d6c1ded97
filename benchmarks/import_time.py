"""Start-up times: `import camgeo`, `camgeo --help` and `camgeo check`, against `import numpy`.

Each round starts a fresh interpreter for each command in turn. CPU times are reported, which other
load on the machine hardly affects: medians of them and of the differences within a round. The check
of a scene with tools plans its program and simulates it, so that of the same scene without its
tables of milling is measured too. The limit for `import camgeo` is numpy's own time plus 60 ms.

    python benchmarks/import_time.py [--rounds 31] [--scene fixtures/scenes/setzhub.toml]
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]

LIMIT: Final = 0.060
"""Most that `import camgeo` may take beyond `import numpy` [s]."""

ENVIRONMENT: Final = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
"""Compiled modules are kept between runs, as for any user of the program."""

REFERENCE: Final = "import numpy"

MILLING: Final = re.compile(
    r"^\[+(?:tool|stock|holding|operation|output\.gcode)[\].](?:.*\n)(?:(?!\[).*\n?)*", re.MULTILINE
)
"""A table on milling, up to the next one."""


def spent() -> float:
    """CPU time of all processes started so far [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def unmilled(scene: Path) -> str:
    """The text of a scene without its tables on milling, and without a program to be written."""
    return MILLING.sub("", scene.read_text("utf-8")).replace('"gcode", ', "")


def seconds(command: list[str]) -> float:
    """CPU time of a command in a fresh process [s]; a command that fails is no measurement."""
    began = spent()
    done = subprocess.run(
        command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, check=False
    )
    took = spent() - began
    # `check` exits 1 where a limit is broken; so does an interpreter with a traceback.
    if done.returncode not in {0, 1} or "Traceback" in done.stderr:
        raise SystemExit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
    return took


def main() -> int:
    """Compare; exit 1 if `import camgeo` is over the limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=31)
    parser.add_argument("--scene", default="fixtures/scenes/setzhub.toml")
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "unmilled.toml"
        plain.write_text(unmilled(ROOT / arguments.scene), "utf-8")
        return compare(arguments.scene, str(plain), arguments.rounds)


def compare(scene: str, plain: str, rounds: int) -> int:
    """Measure and print for the scene, with and without milling; the exit code."""
    check = [sys.executable, "-m", "camgeo", "check"]
    commands = {
        "bare interpreter": [sys.executable, "-c", "pass"],
        REFERENCE: [sys.executable, "-c", "import numpy"],
        "import camgeo": [sys.executable, "-c", "import camgeo"],
        "camgeo --help": [sys.executable, "-m", "camgeo", "--help"],
        "check, no milling": [*check, plain],
        "camgeo check": [*check, scene],
    }
    for command in commands.values():  # fills the caches of bytecode and of the disk
        seconds(command)
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(rounds):
        for name, command in commands.items():
            times[name].append(seconds(command))

    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}, "
        f"{rounds} rounds, {scene}\n"
    )
    print(f"{'':<18}{'median':>10}{'least':>10}{'beyond numpy':>15}{'times numpy':>13}")
    reference = times[REFERENCE]
    beyond = {}
    for name, own in times.items():
        beyond[name] = statistics.median(a - b for a, b in zip(own, reference, strict=True))
        ratio = statistics.median(a / b for a, b in zip(own, reference, strict=True))
        print(
            f"{name:<18}{1e3 * statistics.median(own):>7.1f} ms{1e3 * min(own):>7.1f} ms"
            f"{1e3 * beyond[name]:>12.1f} ms{ratio:>13.2f}"
        )
    kept = beyond["import camgeo"] <= LIMIT
    print(f"\nimport camgeo: numpy + {1e3 * LIMIT:.0f} ms {'kept' if kept else 'EXCEEDED'}")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
