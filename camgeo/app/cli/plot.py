"""`camgeo plot`: pictures of a scene."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.answers.answer import FINE
from camgeo.app.cli.command import (
    IMAGES,
    SCENE_FILE,
    Argument,
    draw_figure,
    notify_main_disc,
    opened,
    output_options,
    write_files,
)

if TYPE_CHECKING:  # figures are imported when one is asked for
    pass

EXAMPLE: Final = "camgeo plot fixtures/scenes/setzhub.toml motion cam -o setzhub.png"


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument("what", metavar="WHAT", nargs="*", help="what to draw; default: everything"),
    *output_options(f"picture, {', '.join(IMAGES)}; default NAME.png", IMAGES),
)


def run(arguments: argparse.Namespace) -> int:
    """Write the picture."""
    from camgeo.pictures import plots

    plots.check_names(arguments.what)
    design = opened(arguments)
    target = Path(arguments.output or f"{design.name}.png")
    figure, wanted = plots.of_design(design, arguments.what)
    picture = draw_figure(figure, target.suffix)
    write_files([(target, picture, ", ".join(wanted))], arguments)
    if set(wanted) - {plots.CAM}:
        notify_main_disc(design, "curves")
    return FINE
