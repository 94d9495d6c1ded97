"""`camgeo import`: a project of another program as a scene."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from camgeo.cli.command import FINE, Subparsers, add_output, new_parser, tell, write_told
from camgeo.errors import Fault, SceneError
from camgeo.scene.ocv import ignored_answer, import_project, scene_name
from camgeo.scene.ocv_layout import COUNT, SIZE, project_numbers


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "import",
        "turn a project of opticurv 1.0.3 (.ocv) into a scene",
        "camgeo import fixtures/reference/ocv/setzhub.ocv -o setzhub.toml",
    )
    parser.add_argument("project", metavar="PROJECT", help="project file (.ocv)")
    add_output(parser, "scene file to write; else the terminal")
    parser.set_defaults(run=partial(run, parser))


def run(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    """Print or write the scene."""
    source = Path(arguments.project)
    target = None if arguments.output is None else Path(arguments.output)
    if target is not None and target.resolve() == source.resolve():
        parser.error(f"argument -o: {arguments.output} is the project itself")
    data = _bytes_of(source)
    text = import_project(data, scene_name(source.stem), str(source))
    if ignored_answer(project_numbers(data)):
        tell(
            "camgeo: question 25 is answered with negativ, which opticurv does not heed where"
            ' question 21 is answered with nein: slider_side = "left" is what it computes'
        )
    if target is None:
        print(text, end="")
        return FINE
    told = f"written; next: camgeo check {target}"
    write_told([(target, text.encode(), told)], force=arguments.force)
    return FINE


def _bytes_of(path: Path) -> bytes:
    """The file's bytes, one more than a project has at most."""
    try:
        with path.open("rb") as stream:
            data = stream.read(SIZE + 1)
        if len(data) > SIZE:
            size = path.stat().st_size
            message = f"a project has {SIZE} bytes, {COUNT} doubles; this file has {size:,}"
            raise SceneError([Fault("", "", message)], str(path))
        return data
    except (OSError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        # A ValueError is Python's answer to a path that no file can have.
        reason = getattr(error, "strerror", None) or str(error)
        fault = Fault("", "", f"the file cannot be read: {reason}")
        raise SceneError([fault], str(path)) from error
