"""`camgeo plot`: pictures of a scene, and the drawing of pictures for all commands."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.answers import answer as render
from camgeo.app.answers.answer import FINE, Answer
from camgeo.app.cli.command import (
    CSV,
    JSON,
    SCENE_FILE,
    Argument,
    Written,
    document,
    notify_main_disc,
    opened,
    output_options,
    table_file,
    write_files,
)

if TYPE_CHECKING:  # figures are imported when one is asked for
    from camgeo.pictures.model import Figure

RENDERERS = "camgeo.renderers"
"""Entry points of renderers: callables that turn a figure into a file, by its suffix."""

RENDERER = "matplotlib"

SUFFIXES = (".png", ".svg", ".pdf")


EXAMPLE: Final = "camgeo plot fixtures/scenes/setzhub.toml motion cam -o setzhub.png"


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument("what", metavar="WHAT", nargs="*", help="what to draw; default: everything"),
    *output_options(f"picture, {', '.join(SUFFIXES)}; default NAME.png", SUFFIXES),
)


def run(arguments: argparse.Namespace) -> int:
    """Write the picture."""
    from camgeo.pictures import plots

    plots.check_names(arguments.what)
    design = opened(arguments)
    target = Path(arguments.output or f"{design.name}.png")
    figure, wanted = plots.of_design(design, arguments.what)
    picture = drawn(figure, target.suffix)
    write_files([(target, picture, ", ".join(wanted))], arguments)
    if set(wanted) - {plots.CAM}:
        notify_main_disc(design, "curves")
    return FINE


def drawn(figure: Figure, suffix: str) -> bytes:
    """The figure as a file of kind `suffix`, one of SUFFIXES."""
    from importlib.metadata import entry_points

    data: bytes = entry_points(group=RENDERERS)[RENDERER].load()(figure, suffix)
    return data


def output_files(answer: Answer, arguments: argparse.Namespace, contents: str) -> list[Written]:
    """The file of `-o`: by its ending the table of an answer, its document or its picture, which is
    reported by its `contents`; none without `-o`.
    """
    if arguments.output is None:
        return []
    target = Path(arguments.output)
    if target.suffix == CSV:
        return [table_file(render.table(answer), target)]
    if target.suffix == JSON:
        return [(target, document(answer).encode(), "the answer")]
    return [(target, drawn(render.figure(answer), target.suffix), contents)]


def picture_options(text: str = "also draw a picture") -> tuple[Argument, Argument]:
    """The options of a command that draws a picture, by default in addition to what it prints."""
    return output_options(f"{text}, {', '.join(SUFFIXES)}", SUFFIXES)
