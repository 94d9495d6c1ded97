"""`camgeo sweep`: what is asked of all designs of a family, kept in a store."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.app.cli import plot
from camgeo.app.cli.command import (
    CallError,
    add_json,
    add_objectives,
    add_repeated,
    add_scene,
    add_workers,
    document,
    ending_in,
    engine_for,
    require_new,
    show,
    write_files,
)
from camgeo.app.cli.streams import notify
from camgeo.units import counted

if TYPE_CHECKING:
    from camgeo.app.answers.sweep import Sweep
    from camgeo.app.cli.command import Written
    from camgeo.studies.sweep.family import Family
    from camgeo.studies.sweep.sweep import Result

STORE: Final = ".sqlite"

SUFFIXES: Final = (STORE, ".csv", ".json")

KINDS: Final = ("map", "parallel", "pareto")

METHODS: Final = ("sobol", "random")

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
    add_repeated(
        parser,
        "--vary",
        "KEY=VALUES",
        "values of a key: START:STOP:COUNT, a list as 5,6,7, or START:STOP with --samples;"
        " KEY,KEY=VALUES ties keys together, VALUE/VALUE for different values; may be repeated",
    )
    add_repeated(
        parser,
        "--ask",
        "NAMES",
        "what is computed of each design: findings as transmission-angle, columns of the value"
        " table as peak:a, max:NAME or min:NAME, diameter, machining-time, verdict;"
        " comma-separated",
    )
    parser.add_argument("--samples", metavar="COUNT", type=int, help="draw this many designs")
    parser.add_argument("--method", choices=METHODS, help="how designs are drawn; default sobol")
    parser.add_argument("--seed", type=int, help="of the samples; default 0")
    add_repeated(
        parser,
        "-o",
        "FILE",
        f"rows, {', '.join(SUFFIXES)}; only a store can be resumed; may be repeated",
        ending_in(SUFFIXES),
        "output",
    )
    parser.add_argument(
        "--picture",
        metavar="FILE",
        type=ending_in(plot.SUFFIXES),
        help=f"also draw a picture, {', '.join(plot.SUFFIXES)}",
    )
    parser.add_argument(
        "--show",
        choices=KINDS,
        help="what it shows: a map over one or two keys, parallel axes, or the Pareto front;"
        " default: the front with --least or --largest, else a map, or axes for more keys",
    )
    add_objectives(
        parser,
        "objectives of the front: what of the answers should be {}",
    )
    where = parser.add_mutually_exclusive_group()
    add_workers(where)
    where.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="compute by the workers of a Dask scheduler, tls://HOST:PORT, or on this machine"
        " tcp://127.0.0.1:PORT; needs the extra camgeo[cluster]",
    )
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--resume", action="store_true", help="compute only what the store does not have"
    )
    group.add_argument("--force", action="store_true", help="overwrite existing files")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Sweep, and print or write what is found."""
    from camgeo.app.answers.sweep import answer_of
    from camgeo.scene.scene import load_scene
    from camgeo.studies.sweep.family import Sample, family_of, questions_of
    from camgeo.studies.sweep.rows import engine_of
    from camgeo.studies.sweep.sweep import sweep

    store, files = _outputs(arguments)
    cluster = arguments.cluster
    engine = engine_for(arguments.workers) if cluster is None else engine_of("cluster", cluster)
    sample = None
    if arguments.samples is not None:
        sample = Sample(arguments.samples, arguments.method or "sobol", arguments.seed or 0)
    elif arguments.method is not None or arguments.seed is not None:
        raise CallError("--method and --seed need --samples")
    scene = load_scene(arguments.scene)
    family = family_of(scene, arguments.vary, sample)
    ask = questions_of(scene, arguments.ask)
    draw = _picture(arguments, family, ask)
    try:
        result = sweep(
            family,
            ask,
            store=store,
            existing="resume" if arguments.resume else "replace" if arguments.force else "refuse",
            engine=engine,
            progress=arguments.progress,
        )
    except KeyboardInterrupt:
        if store is not None and store.exists():
            old = ", or the old ones if none were" if arguments.force else ""
            notify(f"{store}: keeps the rows that were finished{old}; --resume computes the others")
        raise
    try:
        found = answer_of(result)
        if store is not None:
            kept = found.count - result.computed
            known = f", {kept:,} of them known before" if kept else ""
            notify(f"{store}: {counted(found.count, 'row')}{known}")
        written = [_written(found, file) for file in files]
        write_files([*written, *draw(result)], arguments)
        return show(found, arguments)
    finally:
        result.close()


def _picture(
    arguments: argparse.Namespace, family: Family, ask: Sequence[str]
) -> Callable[[Result], list[Written]]:
    """What draws the picture; a wrong call is refused before anything is computed."""
    from camgeo.studies.sweep.family import names_in

    least, largest = names_in(arguments.least), names_in(arguments.largest)
    if arguments.picture is None:
        if arguments.show or least or largest:
            raise CallError("--show, --least and --largest need --picture")
        return lambda _: []
    from camgeo.pictures import sweep as pictures

    usual = "pareto" if least or largest else "map" if len(family.variables) < 3 else "parallel"
    kind = arguments.show or usual
    if (kind == "pareto") != bool(least or largest):
        raise CallError("--show pareto, and no other, needs --least or --largest")
    pictures.require(family, kind)
    if kind == "pareto":
        pictures.objectives(ask, least, largest)

    path = Path(arguments.picture)

    def draw(result: Result) -> list[Written]:
        if kind == "pareto":
            figure = pictures.pareto(result, least, largest)
        else:
            figure = pictures.PICTURES[kind](result)
        return [(path, plot.drawn(figure, path.suffix), kind)]

    return draw


def _outputs(arguments: argparse.Namespace) -> tuple[Path | None, Sequence[Path]]:
    """The store, and the other files."""
    paths = [Path(name) for name in arguments.output]
    stores = [path for path in paths if path.suffix == STORE]
    files = [path for path in paths if path.suffix != STORE]
    if len(stores) > 1:
        raise CallError("-o may name one store only")
    if arguments.resume and not stores:
        raise CallError(f"--resume needs a store: -o FILE{STORE}")
    all_files = [*files, *map(Path, filter(None, [arguments.picture]))]
    if len({path.parent for path in all_files}) > 1 or len(set(files)) < len(files):
        raise CallError("-o and --picture must name different files in one folder")
    if not stores:  # which keeps what is computed
        require_new(all_files, arguments)
    return (stores[0] if stores else None), files


def _written(found: Sweep, path: Path) -> Written:
    from camgeo.app.answers.sweep import comma_separated

    rows = counted(found.count, "row")
    if path.suffix == ".csv":
        return path, comma_separated(found), rows
    return path, document(found).encode(), rows
