"""Files of every format that camgeo reads, made by camgeo and then damaged; and command lines."""

from __future__ import annotations

import argparse
import tempfile
from decimal import Decimal
from functools import cache
from pathlib import Path
from random import Random
from typing import Final

from camgeo.app.answers.answer import table
from camgeo.app.answers.probe import probe
from camgeo.app.cli.main import COMMANDS, parser
from camgeo.design.design import Design
from camgeo.kinematics.laws import FAMILIES
from camgeo.milling.machine import names
from camgeo.milling.machine import names as machines
from camgeo.pictures import plots
from camgeo.scene.formats.format import FORMATS
from camgeo.scene.scene import load_scene
from camgeo.studies.inspection import Align
from camgeo_export.verify.threemf import unpack_parts
from tests.fuzz.case import SCENE, Case, Step
from tests.fuzz.drawn import WORDS
from tests.fuzz.scenes import FIXTURES, fixtures
from tests.hostile.mutations import mutated, repacked

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
    return table(probe(design, design.cam.contact.main, step=Decimal(4), ball=1.5)).csv().encode()


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
    damaged = repacked(unpack_parts(files[target]), rng) if packs else mutated(files[target], rng)
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


# Command lines: every command with its own options, as its parser declares them -------------------


NUMBERS: Final = ("0", "1", "2", "5", "10", "30", "45", "60", "90", "0.5", "0.1", "100", "360")

BROKEN: Final = (
    *("-1", "-0", "1e-300", "1e308", "1e999", "5e-324", "nan", "inf", "-inf", "NaN", "0x10", "1,5"),
    *(" 1", "1_0", "٣", "1e-7", "1" * 400, "1e99999999999", "--", "-", "/", ".", *WORDS),
)

NAMES: Final = ("CUT", "0", "polynomial-345", "laws", "cams", "outlines", *FAMILIES, *plots.names())

BY_METAVAR: Final = {
    "SCENE": (SCENE,),
    "FILE": (
        "o.svg",
        "o.png",
        "o.csv",
        "o.toml",
        "o.json",
        "o.pdf",
        "o.html",
        "sub/o.svg",
        "o",
        "o.sqlite",
    ),
    "DIR": ("out", ".", "a/b/c"),
    "FORMATS": (
        "dxf",
        "dxf,csv",
        "svg",
        "gcode",
        "asc,dxf",
        "dxf,dxf",
        ",",
        "stl",
        ",".join(FORMATS),
    ),
    "FILE|DIR": ("out", "out/cam.dxf", "out/certificate.json", "."),
    "PROGRAM": ("out/setzhub.ngc", "out/cam.ngc", "out/setzhub.dxf", SCENE, "."),
    "NAME|PROFILE": (*machines(), SCENE),
    "D=MM": ("1=3", "7=0.5", "1=0", "1", "=3", "x=1"),
    "CONTOUR": ("out/cam.dxf", "out/cam.csv"),
    "MEASURED": ("points.csv", "out/setzhub.csv", "points-outer.csv"),
    "PROJECT": ("project.ocv",),
    "WHAT": tuple(plots.names()),
    "KEY=VALUES": (
        "follower.base_radius=40:60:3",
        "cam.speed=60,90",
        "motion.2.law=modified-sine,cycloidal",
        "follower.base_radius=40:60",
        "motion.1.dwell,motion.3.dwell=20/10,10/20",
        "name=a,b",
    ),
    "NAMES": ("transmission-angle", "verdict,laws", "diameter,peak:a", "peak:mu,min:kappa", "mass"),
    "COUNT": ("1", "3", "5"),
    "COMMAND": ("check", "build", "table"),
    "NAME": NAMES,
}


ENDING: Final = tuple(each for each in COMMANDS if each != "design")
"""Commands that end by themselves."""


@cache
def commands() -> dict[str, argparse.ArgumentParser]:
    """The parsers of all commands."""
    actions = parser()._actions
    (found,) = (each for each in actions if isinstance(each, argparse._SubParsersAction))
    return dict(found.choices)


def line_case(rng: Random) -> Case:
    """Two command lines in a folder with a scene, its files and a project."""
    path = rng.choice(fixtures())
    files = {SCENE: path.read_bytes()}
    files |= {each.name: each.read_bytes() for each in path.parent.glob("*.csv")}
    files |= {
        f"out/{name}": data for name, data in outputs("setzhub").items() if rng.random() < 0.5
    }
    files["points.csv"] = probed(rng.choice(("setzhub", "tappet")))
    files["project.ocv"] = rng.choice(tuple(ocv_projects())).read_bytes()
    return Case(files, (line(rng), line(rng)), f"command lines, {path.stem}")


@cache
def ocv_projects() -> tuple[Path, ...]:
    """Projects of the reference program."""
    return tuple(sorted((FIXTURES / "reference" / "ocv").glob("*.ocv")))


def line(rng: Random) -> Step:
    """A command with some of its options, in 7 of 10 all with values that they may take."""
    broken = rng.random() < 0.3
    command = rng.choice(ENDING)
    if broken and rng.random() < 0.05:
        command = rng.choice((*WORDS, "chek", "--version", "--help", "crank-slide"))
    words = [command]
    if command not in commands():
        return tuple(words)
    for action in commands()[command]._actions:
        chance = 0.9 if not action.option_strings or action.required else 0.15
        if isinstance(action, argparse._HelpAction):
            chance = 0.01
        if command == "slotted-lever" and action.dest == "crank" and "--swing" in words:
            chance = 0.0
        if rng.random() < chance:
            words += action.option_strings[:1] if rng.random() < 0.9 else action.option_strings[-1:]
            words += values(rng, action, broken=broken)
    if broken and rng.random() < 0.2:
        words.insert(rng.randint(0, len(words)), rng.choice(BROKEN))
    if command == "accuracy" and "--tolerances" not in words:  # the default ones take a minute
        words += ["--tolerances", rng.choice(("1e-1,1e-2", "1e-3", "0.5"))]
    if command == "optimise" and "--evaluations" not in words:  # the usual 2,000 take minutes
        words += ["--evaluations", "20"]
    if command == "watch":  # it would not end
        words += ["--runs", "1"]
    return tuple(words)


def values(rng: Random, action: argparse.Action, *, broken: bool) -> list[str]:
    """Values for an option or an argument."""
    metavar = action.metavar[0] if isinstance(action.metavar, tuple) else action.metavar
    usual = tuple(map(str, action.choices or ())) or BY_METAVAR.get(metavar or "", NUMBERS)
    match action.nargs:
        case 0:
            count = 0
        case int():
            count = action.nargs
        case "+" | "*":
            count = rng.randint(1, 3)
        case _:
            count = 1
    return [rng.choice(BROKEN if broken and rng.random() < 0.4 else usual) for _ in range(count)]
