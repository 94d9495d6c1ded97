"""`camgeo plot`: pictures of a scene, and the drawing of pictures for all commands."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.answers import render
from camgeo.answers.answer import FINE, Answer
from camgeo.cli.command import (
    Written,
    add_output,
    add_scene,
    notify_main_disc,
    opened,
    write_files,
)
from camgeo.errors import Fault, SceneError, meant

if TYPE_CHECKING:  # figures are imported when one is asked for
    from camgeo.design import Design
    from camgeo.figure.model import Figure

RENDERERS = "camgeo.renderers"
"""Entry points of renderers: callables that turn a figure into a file, by its suffix."""

RENDERER = "matplotlib"

CAM = "cam"
"""The plot that shows both discs of a conjugate pair."""

MOTION = "motion"
EFFECTS = "effects"
"""The plot of the effects that a scene names."""

BACKPLOT = "backplot"
"""The plot of the milling program, drawn only if it is asked for; the others are of the cam."""

SUFFIXES = (".png", ".svg", ".pdf")


SUMMARY: Final = (
    "draw a scene: motion, cam, mechanism, curvature, transmission-angle, effects, backplot"
)

EXAMPLE: Final = "camgeo plot fixtures/scenes/setzhub.toml motion cam -o setzhub.png"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument("what", metavar="WHAT", nargs="*", help="what to draw; default: everything")
    add_output(parser, f"picture, {', '.join(SUFFIXES)}; default NAME.png", SUFFIXES)


def run(arguments: argparse.Namespace) -> int:
    """Write the picture."""
    check_names(arguments.what)
    design = opened(arguments)
    target = Path(arguments.output or f"{design.name}.png")
    figure, wanted = figures(design, arguments.what)
    picture = drawn(figure, target.suffix)
    write_files([(target, picture, ", ".join(wanted))], arguments)
    if set(wanted) - {CAM}:
        notify_main_disc(design, "curves")
    return FINE


def check_names(what: Sequence[str]) -> None:
    """SceneError for the first name that is no plot."""
    from camgeo.figure import plots

    names = plots.names()
    for name in what:
        if name not in names:
            hint = meant(name, names, '"')
            raise SceneError([Fault("plot", name, f"can draw {', '.join(names)}", hint)])


def figures(design: Design, what: Sequence[str]) -> tuple[Figure, list[str]]:
    """The plots `what` of a design as one figure, by default all that it has; and their names.

    Raises
    ------
    SceneError
        If the scene lacks what one of them shows.
    """
    from camgeo.figure import motion, plots

    if EFFECTS in what and not design.scene.effects:
        raise SceneError([Fault("effects", "", "names no effect: there is none to draw")])
    if BACKPLOT in what and design.scene.milling is None:
        raise SceneError([Fault("tool", "", "is not stated: there is no program to draw")])
    possible = [name for name in plots.names() if name not in (EFFECTS, BACKPLOT)]
    possible += [EFFECTS] if design.scene.effects else []
    possible.sort()
    if design.scene.follower is None:
        possible = [MOTION]
    wanted = list(what) or possible
    if wanted == possible == [MOTION]:
        scene = design.scene
        found = motion.of_drive(design.name, scene.unit, design.drive, scene.lift_unit)
        return found, wanted
    return plots.stacked(design.disc, wanted), wanted


def drawn(figure: Figure, suffix: str) -> bytes:
    """The figure as a file of kind `suffix`, one of SUFFIXES."""
    from importlib.metadata import entry_points

    data: bytes = entry_points(group=RENDERERS)[RENDERER].load()(figure, suffix)
    return data


def pictures(answer: Answer, arguments: argparse.Namespace, contents: str) -> list[Written]:
    """The picture of an answer, reported by its `contents`; none without `-o`."""
    if arguments.output is None:
        return []
    target = Path(arguments.output)
    return [(target, drawn(render.figure(answer), target.suffix), contents)]


def add_picture(parser: argparse.ArgumentParser, text: str = "also draw a picture") -> None:
    """The options of a command that draws a picture, by default in addition to what it prints."""
    add_output(parser, f"{text}, {', '.join(SUFFIXES)}", SUFFIXES)
