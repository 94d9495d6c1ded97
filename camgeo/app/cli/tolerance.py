"""`camgeo tolerance`: what the tolerances of dimensions do to the position of the follower."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.cli.command import (
    Written,
    add_json,
    add_output,
    add_scene,
    document,
    opened,
    show,
    tables,
    write_files,
)
from camgeo.app.cli.plot import SUFFIXES, pictures

if TYPE_CHECKING:
    from camgeo.app.answers.tolerance import ToleranceAnalysis

TABLE: Final = ".csv"

RECORD: Final = ".json"

EXAMPLE: Final = (
    "camgeo tolerance fixtures/tolerance/lever.toml -o tolerance.png\n"
    "  camgeo tolerance my-cam.toml --count 4096 --seed 1 -o errors.csv"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--count",
        type=int,
        help="random machines that are replayed; default 1024, 0 for the linear analysis alone",
    )
    parser.add_argument("--seed", type=int, default=0, help="of what is drawn; default 0")
    add_json(parser)
    contents = (
        f"file to write: a table ({TABLE}), a picture ({', '.join(SUFFIXES)}), or the answer"
        f" ({RECORD})"
    )
    add_output(parser, contents, (TABLE, RECORD, *SUFFIXES))


def run(arguments: argparse.Namespace) -> int:
    """Analyse, print the answer, and write it."""
    from camgeo.app.answers.tolerance import tolerance  # with all that it needs
    from camgeo.studies.tolerancing.linear import COUNT

    count = COUNT if arguments.count is None else arguments.count
    found = tolerance(opened(arguments), count=count, seed=arguments.seed)
    write_files(_files(found, arguments), arguments)
    return show(found, arguments)


def _files(found: ToleranceAnalysis, arguments: argparse.Namespace) -> list[Written]:
    name = arguments.output or ""
    if name.endswith(TABLE):
        return tables(found, name)
    if name.endswith(RECORD):
        return [(Path(name), document(found).encode(), "the answer")]
    return pictures(found, arguments, "errors over the cam angle")
