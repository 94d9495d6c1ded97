"""`camgeo new`: a commented scene to start from."""

from __future__ import annotations

import argparse
from pathlib import Path

from camgeo.cli.command import FINE, Subparsers, add_output, new_parser, write_told
from camgeo.cli.earlier import present_name
from camgeo.scene.new import KINDS, template


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "new",
        "write a commented scene to start from",
        "camgeo new oscillating-roller -o my-cam.toml",
    )
    parser.add_argument(
        "kind",
        metavar="KIND",
        nargs="?",
        type=present_name,
        default=KINDS[0],
        choices=KINDS,
        help=", ".join(KINDS),
    )
    add_output(parser, "file to write; else the terminal")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print or write the template."""
    text = template(arguments.kind)
    if arguments.output is None:
        print(text, end="")
        return FINE
    target = Path(arguments.output)
    told = f"written; next: camgeo check {target}"
    write_told([(target, text.encode(), told)], force=arguments.force)
    return FINE
