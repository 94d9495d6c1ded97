"""`camgeo machines`: the machine profiles, and a check of one's own."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers.machines import machine, machines
from camgeo.app.cli.command import add_json, show

EXAMPLE: Final = "camgeo machines haas"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument(
        "profile", metavar="PROFILE", nargs="?",
        help="name of a profile, or a profile file (TOML); default: list them all",
    )  # fmt: skip
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the list, or the profile that is named."""
    found = machines() if arguments.profile is None else machine(arguments.profile)
    return show(found, arguments)
