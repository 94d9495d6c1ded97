"""`camgeo optimise`: the design of a family that is best in what is asked, within limits."""

from __future__ import annotations

import argparse
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.answers.answer import STOPPED
from camgeo.app.cli import plot
from camgeo.app.cli.command import (
    CallError,
    Written,
    add_json,
    add_objectives,
    add_repeated,
    add_scene,
    add_workers,
    document,
    ending_in,
    engine_for,
    number,
    require_new,
    show,
    write_files,
)
from camgeo.app.cli.streams import notify
from camgeo.units import counted

if TYPE_CHECKING:
    from camgeo.app.answers.optimise import Optimum

SUFFIXES: Final = (".toml", ".json", ".csv", *plot.SUFFIXES)

EXAMPLE: Final = (
    "camgeo optimise fixtures/scenes/setzhub.toml --vary follower.base_radius=40:60"
    " --vary motion.2.law=modified-sine,polynomial-345 --least diameter"
    " --keep 'transmission-angle>=42' -o best.toml\n"
    "  camgeo optimise my-cam.toml --vary follower.base_radius=36:60 --vary follower.arm=55:70"
    " --least diameter --largest transmission-angle -o best.toml -o front.png"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_repeated(
        parser,
        "--vary",
        "KEY=VALUES",
        "values of a key: LOW:HIGH for any number between, START:STOP:COUNT, or a list as"
        " 5,6,7; KEY,KEY=VALUES ties keys together; may be repeated",
    )
    add_objectives(
        parser,
        "objectives that should be {}: findings as transmission-angle, columns as"
        " peak:a, max:NAME or min:NAME, diameter; comma-separated",
    )
    add_repeated(
        parser,
        "--keep",
        "LIMIT",
        "'NAME>=NUMBER' or 'NAME<=NUMBER', besides the limits of the scene, or in place of its"
        " own on the same finding; may be repeated",
    )
    add_repeated(
        parser,
        "--ignore",
        "NAMES",
        "findings whose limits in the scene do not count, or limits for all of them",
    )
    parser.add_argument("--seed", type=int, help="of what is drawn; default 0")
    parser.add_argument(
        "--evaluations", metavar="COUNT", type=int, help="designs that may be tried; default 2000"
    )
    parser.add_argument(
        "--seconds", type=number, help="after which no other design is tried; default: no limit"
    )
    add_workers(parser)
    add_repeated(
        parser,
        "-o",
        "FILE",
        "the scene of the best design, .toml; the record, .json; all designs that were tried,"
        " .csv; the front or the course of the search, .png, .svg, .pdf; may be repeated",
        ending_in(SUFFIXES),
        "output",
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Search, print the answer, and write what was found."""
    from camgeo.app.answers.optimise import Optimum
    from camgeo.scene.scene import load_scene
    from camgeo.studies.optimise.optimise import optimise
    from camgeo.studies.optimise.task import task_of
    from camgeo.studies.sweep.family import names_in

    files = [Path(name) for name in arguments.output]
    if len({path.parent for path in files}) > 1 or len(set(files)) < len(files):
        raise CallError("-o must name different files in one folder")
    require_new(files, arguments)
    scene = load_scene(arguments.scene)
    folder = Path(arguments.scene).resolve().parent
    for path in files:
        if path.suffix == ".toml" and scene.files and path.resolve().parent != folder:
            raise CallError(f"-o {path} must be in the folder of SCENE, which names files")
    task = task_of(
        scene,
        arguments.vary,
        least=names_in(arguments.least),
        largest=names_in(arguments.largest),
        keep=arguments.keep,
        ignore=names_in(arguments.ignore),
    )
    found = optimise(
        task,
        seed=arguments.seed,
        evaluations=arguments.evaluations,
        seconds=arguments.seconds,
        engine=engine_for(arguments.workers),
        progress=arguments.progress,
    )
    answer = Optimum(found)
    if found.made is not None:
        write_files([_written(answer, path) for path in files], arguments)
    elif files:
        notify("nothing was written: no design that was tried keeps all limits")
    code = show(answer, arguments)
    return STOPPED + signal.SIGINT if found.interrupted else code


def _written(answer: Optimum, path: Path) -> Written:
    from camgeo.app.answers import answer as render
    from camgeo.app.answers.optimise import comma_separated

    if path.suffix == ".toml":
        scene = answer.found.scene
        assert scene is not None  # as something is written
        return path, scene.to_toml().encode(), "the best design"
    if path.suffix == ".csv":
        return path, comma_separated(answer), counted(answer.evaluations, "row")
    if path.suffix == ".json":
        return path, document(answer).encode(), "the record"
    return path, plot.drawn(render.figure(answer), path.suffix), "picture"
