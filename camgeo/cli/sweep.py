"""`camgeo sweep`: what is asked of all designs of a family, kept in a store."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.cli.command import CallError, add_json, add_scene, show, write_files
from camgeo.cli.streams import notify
from camgeo.wording import counted

if TYPE_CHECKING:
    from camgeo.answers.sweep import Sweep
    from camgeo.cli.command import Written

STORE: Final = ".sqlite"

SUFFIXES: Final = (STORE, ".csv", ".json")

METHODS: Final = ("sobol", "random")

SUMMARY: Final = "compute what is asked of a whole family of designs, and keep it in a file"

EXAMPLE: Final = (
    "camgeo sweep fixtures/scenes/setzhub.toml --vary follower.base_radius=40:60:21"
    " --vary motion.2.law=modified-sine,polynomial-345"
    " --ask transmission-angle,peak:a,diameter -o runs.sqlite\n"
    "  camgeo sweep my-cam.toml --vary follower.base_radius=30:60"
    " --vary follower.roller_radius=5:12 --samples 256 --ask verdict,transmission-angle -o runs.csv"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--vary",
        metavar="KEY=VALUES",
        action="append",
        default=[],
        help="values of a key: START:STOP:COUNT, a list as 5,6,7, or START:STOP with --samples;"
        " KEY,KEY=VALUES ties keys together, VALUE/VALUE for different values; may be repeated",
    )
    parser.add_argument(
        "--ask",
        metavar="NAMES",
        action="append",
        default=[],
        help="what is computed of each design: findings as transmission-angle, columns of the value"
        " table as peak:a, max:NAME or min:NAME, diameter, verdict; comma-separated",
    )
    parser.add_argument("--samples", metavar="COUNT", type=int, help="draw so many designs")
    parser.add_argument("--method", choices=METHODS, help="how designs are drawn; default sobol")
    parser.add_argument("--seed", type=int, help="of what is drawn; default 0")
    parser.add_argument(
        "-o",
        metavar="FILE",
        dest="output",
        action="append",
        type=_named,
        default=[],
        help=f"rows, {', '.join(SUFFIXES)}; only a store can be resumed; may be repeated",
    )
    parser.add_argument(
        "--workers",
        metavar="COUNT",
        type=int,
        default=1,
        help="processes of this machine that compute; default 1, 0 for one on each core",
    )
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--resume", action="store_true", help="compute only what the store does not have"
    )
    group.add_argument("--force", action="store_true", help="overwrite existing files")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Sweep, and print or write what is found."""
    from camgeo.answers.sweep import answer_of
    from camgeo.scene.load import load_scene
    from camgeo.sweep.engine import engine_of
    from camgeo.sweep.family import Sample
    from camgeo.sweep.stated import family_of, questions_of
    from camgeo.sweep.sweep import sweep

    store, files = _outputs(arguments)
    workers = arguments.workers or os.cpu_count() or 1
    engine = engine_of("loop" if workers == 1 else "pool", workers)
    sample = None
    if arguments.samples is not None:
        sample = Sample(arguments.samples, arguments.method or "sobol", arguments.seed or 0)
    elif arguments.method is not None or arguments.seed is not None:
        raise CallError("--method and --seed need --samples")
    scene = load_scene(arguments.scene)
    family = family_of(scene, arguments.vary, sample)
    try:
        result = sweep(
            family,
            questions_of(scene, arguments.ask),
            store=store,
            existing="resume" if arguments.resume else "replace" if arguments.force else "refuse",
            engine=engine,
            progress=arguments.progress,
        )
    except KeyboardInterrupt:
        if store is not None and store.exists():
            notify(f"{store}: keeps the rows that were finished; --resume computes the others")
        raise
    try:
        found = answer_of(result)
        if store is not None:
            kept = found.count - result.computed
            known = f", {kept:,} of them known before" if kept else ""
            notify(f"{store}: {counted(found.count, 'row')}{known}")
        write_files([_written(found, file) for file in files], arguments)
        return show(found, arguments)
    finally:
        result.close()


def _named(name: str) -> Path:
    if Path(name).suffix not in SUFFIXES:
        raise argparse.ArgumentTypeError(f"{name!r} must end in one of {', '.join(SUFFIXES)}")
    return Path(name)


def _outputs(arguments: argparse.Namespace) -> tuple[Path | None, Sequence[Path]]:
    """The store, and the other files."""
    stores = [path for path in arguments.output if path.suffix == STORE]
    files = [path for path in arguments.output if path.suffix != STORE]
    if len(stores) > 1:
        raise CallError("-o may name one store only")
    if arguments.resume and not stores:
        raise CallError(f"--resume needs a store: -o FILE{STORE}")
    if len({path.parent for path in files}) > 1 or len(set(files)) < len(files):
        raise CallError("-o must name different files in one folder")
    return (stores[0] if stores else None), files


def _written(found: Sweep, path: Path) -> Written:
    from camgeo.answers import render
    from camgeo.answers.sweep.rendering import comma_separated

    rows = counted(found.count, "row")
    if path.suffix == ".csv":
        return path, comma_separated(found), rows
    document = json.dumps(render.to_json(found), indent=2, allow_nan=False)
    return path, f"{document}\n".encode(), rows
