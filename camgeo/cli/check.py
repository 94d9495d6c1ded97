"""`camgeo check`: the findings of a scene."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.answers.check import check
from camgeo.cli.command import add_json, add_scene, opened, show
from camgeo.cli.progress import Progress

SUMMARY: Final = (
    "hold a scene to its limits; exit 0 fine, 1 a limit is broken, 2 the scene is wrong"
)

EXAMPLE: Final = "camgeo check fixtures/scenes/setzhub.toml"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the findings, and what would cure undercut."""
    with Progress() as progress:
        found = check(opened(arguments, progress))
    return show(found, arguments)
