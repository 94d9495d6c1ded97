"""`camgeo new`: a commented scene to start from."""

from __future__ import annotations

import argparse
from pathlib import Path

from camgeo.cli.command import FINE, Subparsers, new_parser, tell
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
        "kind", metavar="KIND", nargs="?", default=KINDS[0], choices=KINDS, help=", ".join(KINDS)
    )
    parser.add_argument(
        "-o", metavar="FILE", dest="output", help="file to write; else the terminal"
    )
    parser.add_argument("--force", action="store_true", help="write over an existing file")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print or write the template."""
    text = template(arguments.kind)
    if arguments.output is None:
        print(text, end="")
        return FINE
    from camgeo.files.transaction import write_set

    target = Path(arguments.output)
    write_set(target.parent, {target.name: text.encode()}, force=arguments.force)
    tell(f"{target}: written; next: camgeo check {target}")
    return FINE
