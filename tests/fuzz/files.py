"""Files of every format that camgeo reads, made by camgeo and then damaged."""

from __future__ import annotations

import io
import re
import tempfile
import zipfile
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
from tests.fuzz.case import SCENE, Case, Step
from tests.fuzz.drawn import EDGES

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

BUILT: Final = {
    "setzhub": ("dxf", "gcode", "stl", "3mf", "cut-svg", "step", "csv", "asc"),
    "tappet": ("dxf", "csv"),
    "conjugate_lever": ("dxf",),
    "inch": ("dxf", "csv"),
}
"""Scenes whose files are damaged, and the formats."""

TOKEN: Final = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?|[A-Za-z_$]+")

NUMBERS: Final = (
    *(repr(each).encode() for each in EDGES),
    *(b"", b"-", b"9" * 310, b"1e999", b"1.2.3", b"\xff", b"0" * 5000),
)

BYTES: Final = (
    b"\x00",
    b"\xff",
    b"\n",
    b"\r",
    b'"',
    b"<",
    b"[" * 2000,
    b"{",
    b"\xef\xbb\xbf",
    b";",
)


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
        return Case({path.name: damaged(rng, path.read_bytes())}, (("import", path.name),), "ocv")
    if chance < 0.85:
        return _measured(rng)
    name = rng.choice(("measured", "points", "feed", "setzhub"))
    folder = FIXTURES / "scenes"
    files = {SCENE: (folder / f"{name}.toml").read_bytes()}
    files |= {path.name: path.read_bytes() for path in folder.glob(f"{name}*.csv")}
    target = rng.choice(tuple(files))
    files[target] = damaged(rng, files[target])
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
    files = {SCENE: scene, "points.csv": damaged(rng, probed(name))}
    align = rng.choice(tuple(Align))
    step: Step = ("inspect", SCENE, "points.csv", "--align", align, "-o", "o.csv", "--force")
    return Case(files, (step,), f"measured points of {name}")


def _built(rng: Random) -> Case:
    name = rng.choice(("setzhub", *BUILT))
    files = dict(outputs(name))
    target = rng.choice(tuple(files))
    data = files[target]
    damage = damaged_zip if target.endswith(".3mf") and rng.random() < 0.8 else damaged
    scene = (FIXTURES / "scenes" / f"{name}.toml").read_bytes()
    kept = {SCENE: scene, target: damage(rng, data)}
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


def damaged(rng: Random, data: bytes) -> bytes:
    """The data with one to four changes of bytes, tokens or lines."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        data = _changed(rng, data)
    return data


def _changed(rng: Random, data: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    to = min(at + rng.choice((1, 4, 40, 4000)), len(data))
    match rng.randrange(9):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + data[to:]
        case 2:
            return data[:at] + data[at:to] + data[at:]
        case 3:
            return data[:at] + rng.choice(BYTES) + data[at:]
        case 4:
            return data[:at] + rng.randbytes(to - at if to - at < 50 else 4) + data[to:]
        case 5:
            lines = data.split(b"\n")
            first, second = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[first], lines[second] = lines[second], lines[first]
            return b"\n".join(lines)
        case 6:
            return b""
    tokens = list(TOKEN.finditer(data))  # the likeliest change
    if not tokens:
        return data
    one = rng.choice(tokens)
    word = rng.choice((*NUMBERS, rng.choice(tokens).group()))
    return data[: one.start()] + word + data[one.end() :]


def damaged_zip(rng: Random, data: bytes) -> bytes:
    """A damaged member of an archive, packed again."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, "w") as new:
        target = rng.choice((*old.namelist(), "3D/3dmodel.model"))
        for name in old.namelist():
            content = old.read(name)
            new.writestr(name, damaged(rng, content) if name == target else content)
    return stream.getvalue()
