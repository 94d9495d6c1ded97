"""`camgeo table`: the value table as CSV."""

from __future__ import annotations

import argparse
import sys
from decimal import Decimal, InvalidOperation
from pathlib import Path

from camgeo.cli.command import FINE, Subparsers, new_parser, print_json, tell
from camgeo.design import Design
from camgeo.scene.load import load_scene

SMALLEST_STEP = Decimal("0.0001")
LARGEST_STEP = Decimal(90)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "table",
        "print the value table as CSV: motion, curves, transmission angle, curvature",
        "camgeo table fixtures/scenes/setzhub.toml --step 0.5 -o setzhub.csv",
    )
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    parser.add_argument(
        "--step", metavar="DEG", type=_step, help="step of the cam angle in degrees"
    )
    parser.add_argument(
        "-o", metavar="FILE", dest="output", help="file to write; else the terminal"
    )
    parser.add_argument("--force", action="store_true", help="write over an existing file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def _step(text: str) -> Decimal:
    try:
        step = Decimal(text)
    except InvalidOperation:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of degrees") from None
    if not SMALLEST_STEP <= step <= LARGEST_STEP:
        raise argparse.ArgumentTypeError(
            f"{text} degrees; from {SMALLEST_STEP} to {LARGEST_STEP} are allowed"
        )
    return step


def run(arguments: argparse.Namespace) -> int:
    """Print or write the table."""
    table = Design(load_scene(arguments.scene)).table(arguments.step)
    if arguments.json:
        columns = dict(zip(table.names, table.values.T.tolist(), strict=True))
        print_json(columns)
        return FINE
    text = table.csv()
    if arguments.output is None:
        sys.stdout.write(text)
        return FINE
    from camgeo.files.transaction import write_set

    target = Path(arguments.output)
    write_set(target.parent, {target.name: text.encode()}, force=arguments.force)
    tell(f"{target}: {len(table.values)} rows")
    return FINE
