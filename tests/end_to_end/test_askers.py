"""Designs that are pickled, copied, asked by threads and computed by other processes.

Each answers as it does alone: the same findings, and the same bytes of its files.
"""

from __future__ import annotations

import copy
import hashlib
import os
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import Any, Final

import pytest

import camgeo
from camgeo import Design, Scene
from camgeo.check.finding import Finding
from camgeo.design.writing import make_files
from camgeo.errors import CamgeoError, SceneError

SCENES: Final = Path(__file__).parents[2] / "fixtures" / "scenes"

BASES: Final = tuple(
    (SCENES / f"{name}.toml")
    for name in (
        "setzhub", "plate_translating", "groove", "ring", "conjugate_lever", "four_bar", "tappet",
        "constant_breadth", "knife_edge", "crank_slider", "measured", "flat_rocker",
    )
)  # fmt: skip

COUNT: Final = int(os.environ.get("CAMGEO_RANDOM_SCENES", "12"))
"""Random scenes; CONTRIBUTING.md says how to ask for more."""

TRAVELLERS: Final = 2 if COUNT < 100 else COUNT
"""Each of these is computed again after pickling."""

THREADED: Final = 4 if COUNT < 100 else 1
"""Of so many scenes one is asked by threads and one by processes: of the first twelve a linkage, a
pair and a knife edge, and a groove, a face and a lift from data."""

THREADS: Final = 8
PROCESSES: Final = 2

TOLERANCE: Final = 0.01
"""Tolerance of the files [mm]: coarse, since they are only compared with each other."""

Answer = tuple[str, tuple[Finding, ...], str]
"""Identity of the scene, findings, and the hash of its files; or what is wrong instead of both."""


def scene_of(number: int) -> Scene:
    """A fixture scene with some of its values changed at random."""
    rng = Random(number)
    base = camgeo.load(BASES[number % len(BASES)]).scene
    follower = base.values["follower"]
    factor = rng.uniform(0.9, 1.3)
    edits: dict[str, Any] = {
        "name": f"random-{number}",
        "follower.base_radius": round(float(follower["base_radius"]) * factor, 6),
        "cam.rotation": rng.choice(("cw", "ccw")),
    }
    if follower.get("roller_radius"):
        radius = float(follower["roller_radius"])
        edits["follower.roller_radius"] = round(radius * rng.uniform(0.5, 1.5), 6)
    try:
        return base.with_values(edits)
    except SceneError:  # as with another base circle the rocker does not reach it
        return base.with_values({"name": edits["name"], "cam.rotation": edits["cam.rotation"]})


def answer(design: Design) -> Answer:
    """The answers of a design."""
    try:
        findings = design.findings
        files, _ = make_files(design.discs, ("dxf", "csv"), TOLERANCE)
    except CamgeoError as error:
        return design.scene.identity, (), f"{type(error).__name__}: {error}"
    digest = hashlib.sha256(b"".join(name.encode() + files[name] for name in sorted(files)))
    return design.scene.identity, findings, digest.hexdigest()


def unpickled(data: bytes) -> Answer:
    """The answers of a design in another process."""
    design: Design = pickle.loads(data)
    return answer(design)


@pytest.fixture(scope="module")
def scenes() -> tuple[Scene, ...]:
    return tuple(scene_of(number) for number in range(COUNT))


@pytest.fixture(scope="module")
def alone(scenes: tuple[Scene, ...]) -> tuple[Answer, ...]:
    """The answers of each design to one thread of this process."""
    return tuple(answer(Design(scene)) for scene in scenes)


def test_the_scenes_differ_and_most_of_them_have_files(alone: tuple[Answer, ...]) -> None:
    assert len({identity for identity, _, _ in alone}) == len(alone)
    assert sum(bool(findings) for _, findings, _ in alone) >= 0.5 * len(alone)


@pytest.mark.parametrize(
    "travel",
    [lambda value: pickle.loads(pickle.dumps(value)), copy.deepcopy, copy.copy],
    ids=["pickle", "deepcopy", "copy"],
)
def test_a_design_that_has_travelled(
    travel: Callable[[Design], Design], scenes: tuple[Scene, ...], alone: tuple[Answer, ...]
) -> None:
    for scene, expected in list(zip(scenes, alone, strict=True))[:TRAVELLERS]:
        design = Design(scene)
        _ = design.findings if expected[1] else None  # what was computed stays behind
        assert answer(travel(design)) == expected


def test_a_design_that_threads_ask(scenes: tuple[Scene, ...], alone: tuple[Answer, ...]) -> None:
    with ThreadPoolExecutor(THREADS) as pool:
        for scene, expected in [*zip(scenes, alone, strict=True)][::THREADED]:
            design = Design(scene)
            found = set(pool.map(lambda _, design=design: answer(design), range(2)))
            asked = (
                tuple(pool.map(lambda _, design=design: design.findings, range(THREADS)))
                if expected[1]
                else ()
            )
            assert found == {expected}
            assert all(each == expected[1] for each in asked)


def test_designs_in_other_processes(scenes: tuple[Scene, ...], alone: tuple[Answer, ...]) -> None:
    data = [pickle.dumps(Design(scene)) for scene in scenes[2::THREADED]]
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        assert [*pool.map(unpickled, data)] == [*alone[2::THREADED]]
