"""`camgeo report`: all that is known of a design, on one page to be looked at."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.cli.command import add_json, add_output, add_scene, opened, show, write_files

PAGES: Final = "camgeo.pages"
"""Entry points of pages: callables that make an HTML file of an answer."""

EXAMPLE: Final = "camgeo report fixtures/scenes/setzhub.toml -o setzhub.html"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_output(parser, "page to write, .html; default: print a summary", (".html",))
    parser.add_argument(
        "--quick",
        action="store_true",
        help="leave out price list and certificate, for which files are made",
    )
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the summary, or write the page."""
    from importlib.metadata import entry_points

    from camgeo.app.answers.report import report

    found = report(opened(arguments), quick=arguments.quick, progress=arguments.progress)
    if arguments.output is None or arguments.json:
        code = show(found, arguments)
    if arguments.output is not None:
        page: bytes = entry_points(group=PAGES)["report"].load()(found)
        write_files([(Path(arguments.output), page, "report")], arguments)
        code = found.exit_code
    return code
