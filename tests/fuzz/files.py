"""Files of every format that camgeo reads, made by camgeo and then damaged."""

from __future__ import annotations

import tempfile
from decimal import Decimal
from functools import cache
from pathlib import Path
from random import Random
from typing import Final

from camgeo.app.answers.answer import table
from camgeo.app.answers.probe import probe
from camgeo.design.design import Design
from camgeo.milling.machine import names
from camgeo.scene.scene import load_scene
from camgeo.studies.inspection import Align
from camgeo_export.verify.threemf import parts_of
from tests.fuzz.case import SCENE, Case, Step
from tests.hostile.mutations import mutated, repacked

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

BUILT: Final = {
    "setzhub": ("dxf", "gcode", "stl", "3mf", "cut-svg", "step", "csv", "asc"),
    "tappet": ("dxf", "csv"),
    "conjugate_lever": ("dxf",),
    "inch": ("dxf", "csv"),
}
"""Scenes whose files are damaged, and the formats."""


@cache
def outputs(name: str) -> dict[str, bytes]:
    """The files of a scene, by their names."""
    design = Design(load_scene(FIXTURES / "scenes" / f"{name}.toml"))
    with tempfile.TemporaryDirectory() as folder:
        design.write(folder, BUILT[name])
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def file_case(rng: Random) -> Case:
    """One damaged file, in the folder where it is read."""
    chance = rng.random()
    if chance < 0.7:
        return _built(rng)
    if chance < 0.8:
        path = rng.choice(sorted((FIXTURES / "reference" / "ocv").glob("*.ocv")))
        return Case({path.name: mutated(path.read_bytes(), rng)}, (("import", path.name),), "ocv")
    if chance < 0.85:
        return _measured(rng)
    name = rng.choice(("measured", "points", "feed", "setzhub"))
    folder = FIXTURES / "scenes"
    files = {SCENE: (folder / f"{name}.toml").read_bytes()}
    files |= {path.name: path.read_bytes() for path in folder.glob(f"{name}*.csv")}
    target = rng.choice(tuple(files))
    files[target] = mutated(files[target], rng)
    return Case(files, (("check", SCENE), ("table", SCENE, "--step", "5")), f"read by {name}")


@cache
def probed(name: str) -> bytes:
    """Points of the main flank of a scene, with normals, as for a measuring machine."""
    design = Design(load_scene(FIXTURES / "scenes" / f"{name}.toml"))
    found = probe(design, design.cam.contact.main, step=Decimal(4), ball=1.5)
    return table(found).csv().encode()


def _measured(rng: Random) -> Case:
    name = rng.choice(("setzhub", "tappet", "groove", "trimmed_ring"))
    scene = (FIXTURES / "scenes" / f"{name}.toml").read_bytes()
    files = {SCENE: scene, "points.csv": mutated(probed(name), rng)}
    align = rng.choice(tuple(Align))
    step: Step = ("inspect", SCENE, "points.csv", "--align", align, "-o", "o.csv", "--force")
    return Case(files, (step,), f"measured points of {name}")


def _built(rng: Random) -> Case:
    name = rng.choice(("setzhub", *BUILT))
    files = dict(outputs(name))
    target = rng.choice(tuple(files))
    packs = target.endswith(".3mf") and rng.random() < 0.8
    damaged = repacked(parts_of(files[target]), rng) if packs else mutated(files[target], rng)
    scene = (FIXTURES / "scenes" / f"{name}.toml").read_bytes()
    kept = {SCENE: scene, target: damaged}
    for other in files:
        if other != target and (other.endswith(".json") and rng.random() < 0.7):
            kept[other] = files[other]
    if target == "certificate.json":
        kept[f"{name}.dxf"] = outputs(name)[f"{name}.dxf"]
    steps: list[Step] = [
        ("verify", *(each for each in kept if each not in (SCENE, "certificate.json")))
    ]
    if target == "certificate.json":
        steps.append(("verify", "."))
    if target.endswith(".ngc"):
        steps.append(("lint", target, "--machine", rng.choice(names())))
    if target.endswith((".dxf", ".csv")):
        steps.append(("replay", SCENE, target, "--step", "5"))
    return Case(kept, tuple(steps), f"damaged {target}")
