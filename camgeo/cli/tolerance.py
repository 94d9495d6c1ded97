"""`camgeo tolerance`: what the tolerances of dimensions do to the position of the follower."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.cli.command import add_json, add_output, add_scene, opened, show, tables, write_files
from camgeo.cli.plot import SUFFIXES, pictures

TABLE: Final = ".csv"

SUMMARY: Final = (
    "analyse the tolerances of a scene: the follower's error over the cam angle, by source"
)

EXAMPLE: Final = (
    "camgeo tolerance fixtures/tolerance/lever.toml -o tolerance.png\n"
    "  camgeo tolerance my-cam.toml --json"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_json(parser)
    contents = f"file to write: a table ({TABLE}) or a picture ({', '.join(SUFFIXES)})"
    add_output(parser, contents, (TABLE, *SUFFIXES))


def run(arguments: argparse.Namespace) -> int:
    """Analyse, print the answer, and write it."""
    from camgeo.answers.tolerance import tolerance  # with all that it needs

    found = tolerance(opened(arguments))
    if (arguments.output or "").endswith(TABLE):
        files = tables(found, arguments.output)
    else:
        files = pictures(found, arguments, "errors over the cam angle")
    write_files(files, arguments)
    return show(found, arguments)
