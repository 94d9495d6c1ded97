"""Designs that are pickled, copied, asked by threads and computed by other processes.

Each answers as it does alone: the same findings, and the same bytes of its files.
"""

from __future__ import annotations

import copy
import hashlib
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import cache
from multiprocessing import get_context
from typing import Final

import pytest

import camgeo
from camgeo import Design
from camgeo.check.finding import Finding
from camgeo.design.writing import make_files
from tests.end_to_end.built import SCENES

TOLERANCE: Final = 0.01
"""Tolerance of the files [mm]: coarse, since they are only compared with each other."""

THREADS: Final = 8
PROCESSES: Final = 2

Answer = tuple[tuple[Finding, ...], str]
"""Findings, and the hash of the files."""


def load(name: str) -> Design:
    return camgeo.load(SCENES[0].with_name(f"{name}.toml"))


def answer(design: Design) -> Answer:
    files, _ = make_files(design.discs, ("dxf", "csv"), TOLERANCE)
    digest = hashlib.sha256(b"".join(name.encode() + files[name] for name in sorted(files)))
    return design.findings, digest.hexdigest()


def unpickled(data: bytes) -> Answer:
    """The answers of a design in another process."""
    return answer(pickle.loads(data))


@cache
def alone(name: str) -> Answer:
    """The answers of a design to one thread of this process."""
    return answer(load(name))


@pytest.mark.parametrize("name", ["setzhub", "plate_translating"])
@pytest.mark.parametrize(
    "travel",
    [lambda value: pickle.loads(pickle.dumps(value)), copy.deepcopy, copy.copy],
    ids=["pickle", "deepcopy", "copy"],
)
def test_a_design_that_has_travelled(travel: Callable[[Design], Design], name: str) -> None:
    design = load(name)
    assert design.findings == alone(name)[0]  # what was computed stays behind
    assert answer(travel(design)) == alone(name)


@pytest.mark.parametrize("name", ["setzhub", "conjugate_lever", "knife_edge"])
def test_a_design_that_threads_ask(name: str) -> None:
    design = load(name)
    with ThreadPoolExecutor(THREADS) as pool:
        found = {*pool.map(lambda _: answer(design), range(2))}
        asked = [*pool.map(lambda _: design.findings, range(THREADS))]
    assert found == {alone(name)}
    assert asked == [alone(name)[0]] * THREADS


def test_designs_in_other_processes() -> None:
    names = ("groove", "tappet", "measured")
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        found = [*pool.map(unpickled, [pickle.dumps(load(name)) for name in names])]
    assert found == [alone(name) for name in names]
