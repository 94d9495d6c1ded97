"""Start-up times: `import camgeo` and `camgeo check`, compared with `import numpy`.

Each round starts a fresh interpreter for each command in turn, so that other load on the machine
affects all of them. Medians are reported, of the times and of the differences within a round.
The limit for `import camgeo` is numpy's own time plus 60 ms.

    python benchmarks/import_time.py [--rounds 31] [--scene fixtures/scenes/setzhub.toml]
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]

LIMIT: Final = 0.060
"""Most that `import camgeo` may take beyond `import numpy` [s]."""

ENVIRONMENT: Final = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
"""Compiled modules are kept between runs, as for any user of the program."""

REFERENCE: Final = "import numpy"


def seconds(command: list[str]) -> float:
    """Wall time of a command in a fresh process [s]; a command that fails is no measurement."""
    began = time.perf_counter()
    done = subprocess.run(
        command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, check=False
    )
    took = time.perf_counter() - began
    # `check` exits 1 where a limit is broken; so does an interpreter with a traceback.
    if done.returncode not in {0, 1} or "Traceback" in done.stderr:
        raise SystemExit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
    return took


def main() -> int:
    """Measure and print; exit 1 if `import camgeo` is over the limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=31)
    parser.add_argument("--scene", default="fixtures/scenes/setzhub.toml")
    arguments = parser.parse_args()

    commands = {
        "bare interpreter": [sys.executable, "-c", "pass"],
        REFERENCE: [sys.executable, "-c", "import numpy"],
        "import camgeo": [sys.executable, "-c", "import camgeo"],
        "camgeo check": [sys.executable, "-m", "camgeo", "check", arguments.scene],
    }
    for command in commands.values():  # fills the caches of bytecode and of the disk
        seconds(command)
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(arguments.rounds):
        for name, command in commands.items():
            times[name].append(seconds(command))

    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}, "
        f"{arguments.rounds} rounds, {arguments.scene}\n"
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
