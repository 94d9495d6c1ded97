"""`camgeo compare`: a few designs side by side, as a table and a picture."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from camgeo.app.cli.command import add_json, add_repeated, show, write_files
from camgeo.app.cli.plot import add_picture, pictures

EXAMPLE: Final = (
    "camgeo compare fixtures/scenes/setzhub.toml fixtures/scenes/querhub.toml -o both.png\n"
    "  camgeo compare cam-a.toml cam-b.toml --ask transmission-angle,peak:a,diameter"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument("scenes", metavar="SCENE", nargs="+", help="scene files, two or more")
    add_repeated(
        parser,
        "--ask",
        "NAMES",
        "compare only these, named as for camgeo sweep; comma-separated",
    )
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Compare, and print or draw the results."""
    from camgeo.app.answers.compare import compare
    from camgeo.design.design import Design
    from camgeo.lazy import Ledger
    from camgeo.scene.scene import load_scene
    from camgeo.studies.sweep.family import names_in

    designs = [Design(load_scene(name), Ledger(arguments.progress)) for name in arguments.scenes]
    labels = labels_of(arguments.scenes)
    found = compare(list(zip(labels, designs, strict=True)), names_in(arguments.ask))
    write_files(pictures(found, arguments, "flanks, motion, acceleration, mu"), arguments)
    return show(found, arguments)


def labels_of(names: Sequence[str]) -> list[str]:
    """The stems of files, or their paths if two stems are the same."""
    stems = [Path(name).stem for name in names]
    return stems if len(set(stems)) == len(stems) else list(names)
