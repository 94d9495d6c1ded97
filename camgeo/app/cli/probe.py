"""`camgeo probe`: points of the flanks to be measured, with their true normals."""

from __future__ import annotations

import argparse
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.answers.probe import STEP, Probing, lift_table, probe
from camgeo.app.cli.command import (
    CallError,
    Written,
    add_json,
    add_output,
    add_scene,
    check_step,
    decimal,
    from_0,
    opened,
    positive,
    require_beside,
    show,
    tables,
    write_files,
)
from camgeo.geometry.outline.path import Flank
from camgeo.units import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

SMALLEST_STEP: Final = Decimal("0.01")
LARGEST_STEP: Final = Decimal(30)

TABLE: Final = ".csv"

EXAMPLE: Final = (
    "camgeo probe fixtures/scenes/setzhub.toml --ball 1.5 -o points.csv\n"
    "  camgeo probe my-cam.toml --spacing 0.5 --tolerance 0.02 -o points.csv --lift lift.csv"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--step", metavar="DEG", type=decimal, help=f"step of the cam angle; default {STEP}"
    )
    parser.add_argument(
        "--spacing", metavar="MM", type=positive,
        help="instead of a step: equal distances along the flank, at most this",
    )  # fmt: skip
    parser.add_argument("--flank", choices=tuple(map(str, Flank)), help="flank; default all in use")
    parser.add_argument(
        "--ball", metavar="MM", type=from_0, default=0.0,
        help="radius of the measuring ball: also list its centres, and check that it fits",
    )  # fmt: skip
    parser.add_argument(
        "--tolerance", metavar="MM", type=positive,
        help="also list the deviations allowed: plus and minus half of this profile tolerance",
    )  # fmt: skip
    add_json(parser)
    parser.add_argument(
        "--lift", metavar="FILE", type=_csv, help=f"lift curve to write as well ({TABLE})"
    )
    contents = f"file to write ({TABLE}); of several flanks one each, with -inner, -outer, -return"
    add_output(parser, contents, (TABLE,))


def run(arguments: argparse.Namespace) -> int:
    """List the points, and write them."""
    if arguments.step is not None and arguments.spacing is not None:
        raise CallError("--step and --spacing are both given; only one of them is allowed")
    check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
    require_beside("--lift", arguments.lift, arguments.output)
    found = probe(
        opened(arguments),
        arguments.flank,
        step=arguments.step,
        spacing=arguments.spacing,
        ball=arguments.ball,
        tolerance=arguments.tolerance,
    )
    files = [*_points(found, arguments.output), *_lift(found, arguments.lift)]
    if len({path for path, _, _ in files}) < len(files):
        raise CallError("--lift names the file of a flank")
    write_files(files, arguments)
    return show(found, arguments)


def _points(found: Probing, output: str | None) -> Iterator[Written]:
    """A file of each flank."""
    if output is None:
        return
    main = found.flanks[0]
    for answer in found.each:
        one, name = answer.flanks[0], Path(output)
        ending = one.disc.name.removeprefix(main.disc.name)
        if len(one.disc.cam.contact.flanks) > 1:
            ending += f"-{one.flank}"
        yield from tables(answer, str(name.with_name(f"{name.stem}{ending}{name.suffix}")))


def _lift(found: Probing, output: str | None) -> Iterator[Written]:
    if output is not None:
        table = lift_table(found)
        rows = counted(len(table.values), "row")
        yield Path(output), table.encoded(), f"lift curve, {rows}"


def _csv(name: str) -> str:
    if Path(name).suffix != TABLE:
        raise argparse.ArgumentTypeError(f"{name!r} must end in {TABLE}")
    return name
