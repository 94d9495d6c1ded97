"""`camgeo setup`: the setup sheet of a scene's milling program."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.cli.command import (
    add_json,
    add_output,
    add_scene,
    notify_main_disc,
    opened,
    show,
    write_files,
)

EXAMPLE: Final = "camgeo setup fixtures/scenes/setzhub.toml -o setzhub.html"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_output(parser, "page to write, .html; default: print to the terminal", (".html",))
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the sheet, and write the page."""
    from camgeo.app.answers.setup import html, setup_sheet, svg_element
    from camgeo.app.cli.plot import drawn
    from camgeo.pictures import backplot

    design = opened(arguments)
    sheet = setup_sheet(design)
    if arguments.output is not None:
        picture = svg_element(drawn(backplot.figure(design.disc), ".svg"))
        page = html(sheet, picture).encode("utf-8")
        write_files([(Path(arguments.output), page, "setup sheet")], arguments)
    notify_main_disc(design, "operations")
    return show(sheet, arguments)
