"""`camgeo check`: the findings of a scene."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers.check import check
from camgeo.app.cli.command import add_json, add_scene, opened, show

EXAMPLE: Final = "camgeo check fixtures/scenes/setzhub.toml"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the findings, and what would cure undercut."""
    return show(check(opened(arguments)), arguments)
