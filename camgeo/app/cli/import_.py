"""`camgeo import`: a project of another program as a scene."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.cli.command import CallError, add_output, deliver
from camgeo.app.cli.streams import notify
from camgeo.reading import PROJECT
from camgeo.scene.ocv import ignored_answer, import_project, project_numbers, scene_name
from camgeo.scene.scene import read_file

EXAMPLE: Final = "camgeo import fixtures/reference/ocv/setzhub.ocv -o setzhub.toml"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument("project", metavar="PROJECT", help="project file (.ocv)")
    add_output(parser, "scene file to write; default: print to the terminal")


def run(arguments: argparse.Namespace) -> int:
    """Print or write the scene."""
    source, target = Path(arguments.project), arguments.output
    if target is not None and Path(target).resolve() == source.resolve():
        raise CallError(f"argument -o: {target} is the project itself")
    data = read_file(source, PROJECT.size)
    text = import_project(data, scene_name(source.stem), str(source))
    if ignored_answer(project_numbers(data)):
        notify(
            "camgeo: question 25 is answered with negativ, which opticurv ignores if"
            ' question 21 is answered with nein: slider_side = "left" is what it computes'
        )
    return deliver(text, arguments, f"written; next: camgeo check {target}")
