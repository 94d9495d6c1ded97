"""A benchmark run three times: its output with the median of each number, and on what machine.

Each row of docs/figures.md that a machine decides is such a median. Runs follow one another, so
that what else the machine does is not the same in all three; a line whose words differ from run to
run is printed as the last one has it, marked with "?".

    python benchmarks/thrice.py benchmarks/sizing.py --rounds 25
"""

from __future__ import annotations

import itertools
import os
import platform
import re
import subprocess
import sys
from pathlib import Path
from typing import Final

import numpy as np

RUNS: Final = 3

NUMBER: Final = re.compile(r"(?<![\w.])-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\w)")


def machine() -> str:
    """Processor, cores and versions."""
    known = Path("/proc/cpuinfo")
    names = re.findall(r"^model name\s*: (.*)$", known.read_text() if known.is_file() else "", re.M)
    processor = names[0] if names else platform.processor() or platform.machine()
    return (
        f"{os.cpu_count()} cores of {processor}, {platform.system()},"
        f" Python {platform.python_version()}, numpy {np.__version__}"
    )


def medians(outputs: list[list[str]]) -> list[str]:
    """The lines with the median of each number, as it stands in one of them."""
    found = []
    for lines in zip(*outputs, strict=False):
        words = {re.sub(" +", " ", NUMBER.sub("~", line)) for line in lines}
        if len(words) > 1:
            found.append(f"? {lines[-1]}")
            continue
        each = zip(*(NUMBER.findall(line) for line in lines), strict=True)
        middle = [sorted(texts, key=value)[len(texts) // 2] for texts in each]
        pairs = itertools.zip_longest(NUMBER.split(lines[-1]), middle, fillvalue="")
        found.append("".join(itertools.chain.from_iterable(pairs)))
    return found


def value(text: str) -> float:
    """Of a number as it is printed."""
    return float(text.replace(",", ""))


def main() -> None:
    """Run the benchmark and print."""
    outputs = [
        subprocess.run(
            [sys.executable, *sys.argv[1:]], check=True, stdout=subprocess.PIPE, text=True
        ).stdout.splitlines()
        for _ in range(RUNS)
    ]
    print(f"{machine()}: medians of {RUNS} runs")
    print("\n".join(medians(outputs)))


if __name__ == "__main__":
    main()
