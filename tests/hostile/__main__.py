"""Run the readers on hostile files, `python -m tests.hostile [READER...]`, or on good files that
are mutated, `python -m tests.hostile --mutations 300 --seed 1 [READER...]`; with `--every` on both.

Each reader has a process of its own, forked after all imports; so memory and CPU time are those of
the reader alone. Prints a JSON object for each input: reader, name, reason of the refusal (empty:
none), error (empty: none), seconds of computing (see `tests.speed`) and megabytes.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain, islice
from pathlib import Path
from random import Random
from typing import Any, Final

from camgeo_export.verify.threemf import unpack_parts
from tests.hostile.inputs import (
    Named,
    bodies,
    certificates,
    contours,
    drawings,
    large,
    packages,
    points,
    profiles,
    programs,
    projects,
    scenes,
    solids,
    tables,
    vectors,
)
from tests.hostile.mutations import mutated, repacked
from tests.hostile.readers import ENDINGS, READERS, good
from tests.seeds import add_seed
from tests.speed import cpu_second, spending

INPUTS: Final[dict[str, Callable[[bytes], Named]]] = {
    "dxf": drawings,
    "replay-dxf": partial(drawings, any_text=False),
    "gcode": programs,
    "lint": programs,
    "stl": bodies,
    "3mf": packages,
    "step": solids,
    "cut-svg": vectors,
    "contour": contours,
    "inspect": points,
    "lifts": tables,
    "speeds": partial(tables, any_text=False),
    "loads": partial(tables, any_text=False),
    "motor": partial(tables, any_text=False),
    "scene": scenes,
    "machine": profiles,
    "certificate": certificates,
    "ocv": projects,
}

MUTATED: Final = "seed "
"""Begins the names of mutated files."""

STATUS: Final = Path("/proc/self/status")

LONGEST: Final = 1200
"""CPU time [s] after which the process of a reader is killed."""

MOST: Final = 2_000_000_000
"""Bytes beyond those at its start that it may ever have."""


def memory(what: str) -> float:
    """A figure of the process's memory [MB]; 0 where the system does not state it."""
    if not STATUS.exists():
        return 0.0
    row = next(row for row in STATUS.read_text().splitlines() if row.startswith(f"{what}:"))
    return float(row.split()[1]) / 1000.0


def forget_peak() -> None:
    """Begin the peak of the memory anew."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return


def measured(reader: str, name: str, data: bytes) -> dict[str, Any]:
    """One input, read."""
    forget_peak()
    before = memory("VmRSS")
    reason = error = ""
    with spending() as spent:
        try:
            reason = READERS[reader](data)
        except Exception as unexpected:
            error = f"{type(unexpected).__name__}: {unexpected}"
    return {
        "reader": reader,
        "name": name,
        "reason": reason[:300],
        "error": error[:300],
        "seconds": spent.seconds,
        "megabytes": memory("VmHWM") - before,
    }


def mutants(reader: str, sample: bytes, seeds: range) -> Named:
    """Mutations of a good file; of packages, half of the mutations are of what is packed."""
    parts = unpack_parts(sample) if reader == "3mf" else {}
    for seed in seeds:
        chance = Random(seed)
        data = repacked(parts, chance) if parts and seed % 2 else mutated(sample, chance)
        yield f"{MUTATED}{seed}", data


def work(reader: str, seeds: range, every: int) -> None:
    """Read one of each `every` inputs of a reader, none for 0, and the mutations of these seeds."""
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST))
    limit = int(1e6 * memory("VmSize")) + MOST
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    sample = good(reader)
    READERS[reader](sample)  # what it imports, and what is computed once
    inputs = islice(INPUTS[reader](sample), 0, None, every) if every else iter(())
    for name, data in chain(inputs, mutants(reader, sample, seeds)):
        sys.stdout.write(json.dumps(measured(reader, name, data)) + "\n")
        sys.stdout.flush()


def main(arguments: Sequence[str]) -> int:
    """Fork a process for each reader; 1 if one does not come to its end."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("readers", metavar="READER", nargs="*", help=f"of {', '.join(INPUTS)}")
    parser.add_argument("--every", metavar="N", type=int, help="one of each N inputs")
    parser.add_argument("--mutations", metavar="N", type=int, default=0, help="of each good file")
    add_seed(parser)
    wanted = parser.parse_args(arguments)
    seeds = range(wanted.seed, wanted.seed + wanted.mutations)
    every = int(not seeds) if wanted.every is None else wanted.every
    cpu_second()  # known to all readers
    print(f"mutations of seed {wanted.seed}", file=sys.stderr)  # noqa: T201 - a program
    warnings.simplefilter("error")
    code = 0
    large()
    for name in ENDINGS:
        good(name)
    for reader in wanted.readers or INPUTS:
        child = os.fork()
        if child == 0:
            try:
                work(reader, seeds, every)
            except BaseException as error:
                sys.stderr.write(f"{reader}: {error!r}\n")
                os._exit(1)
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if status:
            sys.stderr.write(f"{reader}: ended with {status}\n")
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
