"""`camgeo new`: a commented scene to start from."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.cli.command import Argument, deliver, output_options, present_name
from camgeo.scene.toml import TEMPLATE_KINDS, template

EXAMPLE: Final = "camgeo new oscillating-roller -o my-cam.toml"


ARGUMENTS: Final = (
    Argument(
        "kind",
        metavar="KIND",
        nargs="?",
        type=present_name,
        default=TEMPLATE_KINDS[0],
        choices=TEMPLATE_KINDS,
        help=", ".join(TEMPLATE_KINDS),
    ),
    *output_options("file to write; default: print to the terminal"),
)


def run(arguments: argparse.Namespace) -> int:
    """Print or write the template."""
    report = f"written; next: camgeo check {arguments.output}"
    return deliver(template(arguments.kind), arguments, report)
