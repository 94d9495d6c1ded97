"""`camgeo explain`: what a command computes for a scene, why, and how long it takes."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers.explain import GOALS, explain
from camgeo.app.cli.command import add_json, add_scene, opened, show

EXAMPLE: Final = "camgeo explain fixtures/scenes/setzhub.toml build"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "command", metavar="COMMAND", nargs="?", default="check", choices=tuple(GOALS),
        help=f"one of {', '.join(GOALS)}; default check. nothing is written",
    )  # fmt: skip
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Compute what the command would, and print how long each quantity took."""
    design = opened(arguments)
    found = explain(design, arguments.command)
    return show(found, arguments)
