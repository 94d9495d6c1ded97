"""`camgeo replay`: what the follower does on the real disc, or on any contour from a file."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from camgeo.answers.answer import FINE
from camgeo.cli.command import (
    CallError,
    add_json,
    add_output,
    add_scene,
    check_step,
    decimal,
    identity,
    opened,
    print_json,
    tell,
    write_told,
)
from camgeo.cli.plot import SUFFIXES, drawn
from camgeo.cli.replay_told import Scale, closing_lines, closing_of, lines_of, record_of
from camgeo.contour.contour import Contour
from camgeo.design import Design
from camgeo.errors import Fault, SceneError
from camgeo.files.product import Product, disc_of
from camgeo.files.value_table import Table, cam_angles
from camgeo.mechanism.follower_path import path_of
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.path import Flank
from camgeo.outline.replay import CORNER, replay_contour, replay_outline
from camgeo.outline.replay_result import Replay
from camgeo.units import MM_PER, LengthUnit

READERS: Final = "camgeo.readers"
"""Entry points that read contours from files, by what the file's name ends in without the dot."""

STEP: Final = Decimal("0.1")
SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(10)

GAP: Final = 1e-3
"""End points of a drawing up to this far apart [mm] are joined: the last digit that most programs
write."""

FLAT: Final = 1e-3
"""Corners of a drawing up to this angle [degrees] are not counted: pieces of 0.1 mm whose ends are
written with six decimals meet at angles of this size."""

OUTLINE_SAMPLES: Final = 3601


class Reader(Protocol):
    """Reads closed contours [mm] from a file of one format, the largest first."""

    def read(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Contour, ...]: ...


SUMMARY: Final = (
    "roll the roller over the real outline, or over a contour from a file: lift, velocity,"
    " acceleration, shocks, against what is demanded"
)

EXAMPLE: Final = (
    "camgeo replay fixtures/scenes/setzhub.toml\n"
    "  camgeo replay fixtures/scenes/setzhub.toml out/setzhub.dxf -o ripple.png\n"
    "  camgeo replay my-cam.toml measured.csv --unit mm --json\n"
    "  camgeo replay pair.toml out/pair.dxf out/pair-return.dxf"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "contours",
        metavar="CONTOUR",
        nargs="*",
        help="drawing (DXF), or vertices (CSV: x, y, bulge), in the axes of the scene's cam;"
        " default the scene's real outline. Of a conjugate pair one of each disc, or of one disc"
        " alone: that of the return disc has a name that ends in -return",
    )
    parser.add_argument("--layer", metavar="NAME", help="layer of the drawing; default CUT, or all")
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of CONTOUR, if it does not say one"
    )
    parser.add_argument(
        "--gap", metavar="MM", type=_from_0, default=GAP,
        help=f"end points of a drawing up to this far apart are joined; default {GAP:g}",
    )  # fmt: skip
    parser.add_argument(
        "--corner", metavar="DEG", type=_from_0, default=FLAT,
        help=f"corners of CONTOUR up to this angle count as none; default {FLAT:g}",
    )  # fmt: skip
    parser.add_argument(
        "--flank", choices=tuple(Flank), help="flank of the roller; default the scene's"
    )
    parser.add_argument(
        "--step", metavar="DEG", type=decimal, default=STEP,
        help=f"step of the cam angle; default {STEP}",
    )  # fmt: skip
    add_json(parser)
    told = f"file to write: a table (.csv) or a picture ({', '.join(SUFFIXES)})"
    add_output(parser, told, (".csv", *SUFFIXES))


def run(arguments: argparse.Namespace) -> int:
    """Replay, and print or write what comes of it."""
    step = arguments.step
    check_step(step, SMALLEST_STEP, LARGEST_STEP)
    design = opened(arguments)
    path_of(design.cam.follower, design.cam.rotation)  # of rollers alone
    flank = Flank(arguments.flank or design.cam.contact.main)
    found = [
        _replayed(disc, file, flank, float(step), arguments)
        for disc, file in _discs(design, flank, arguments.contours)
    ]
    pair = (found[0].replay, found[1].replay) if len(found) == 2 else None
    first = found[0]
    scale = _scale(design)
    if arguments.output is not None:
        what = f"{flank} flank, {first.source}"
        _write(first.disc, first.replay, scale, step, what, arguments, pair)
    records = [record_of(each.disc.cam, each.replay, scale) for each in found]
    closing = None if pair is None else closing_of(design.cam, *pair)
    if arguments.json:
        told = {"contour": first.source, "flank": flank, **records[0]}
        if closing is not None:
            other = found[1]
            told["return"] = {"name": other.disc.name, "contour": other.source, **records[1]}
            told["closing"] = closing
        print_json({**identity(first.disc.scene), **told})
    else:
        for each, record in zip(found, records, strict=True):
            print(f"{each.disc.name}: the roller on {each.source}, {flank} flank")
            print("\n".join(lines_of(record)))
        if closing is not None:
            print(f"{design.name}: both discs")
            print("\n".join(closing_lines(closing)))
    return FINE


def _from_0(text: str) -> float:
    number = float(text)
    if not (math.isfinite(number) and number >= 0.0):
        raise argparse.ArgumentTypeError("must be a number from 0 on")
    return number


@dataclass(frozen=True, slots=True, eq=False)
class _Replayed:
    """A disc, what its roller was replayed on, and what came of it."""

    disc: Product
    source: str
    replay: Replay


def _discs(design: Design, flank: Flank, files: list[str]) -> list[tuple[Product, str | None]]:
    """The discs to replay, the main one first, each with its file or None for its real outline."""
    discs = design.discs
    if len(files) > len(discs):
        raise CallError(
            "argument CONTOUR: one file at most, for the scene has one disc"
            if len(discs) == 1
            else "argument CONTOUR: two files at most, one of each disc"
        )
    if len(discs) == 1 or flank is Flank.OUTER:
        return [(design.disc, files[0] if files else None)]
    if not files:
        return [(disc, None) for disc in discs]
    named = [disc_of(discs, Path(file).stem) for file in files]
    if len(files) == 1:
        return [(named[0], files[0])]
    if named == [*reversed(discs)]:
        files = files[::-1]
    return list(zip(discs, files, strict=True))


def _replayed(
    disc: Product, file: str | None, flank: Flank, step: float, arguments: argparse.Namespace
) -> _Replayed:
    """The roller of a disc on its outline, or on the contour of a file; `step` in degrees."""
    angle = math.radians(step)
    if file is None:
        path, clearance = disc.cam.disc.outline(flank).path, disc.cam.clearance
        replay = replay_outline(disc.cam.disc.pitch_curve, path, step=angle, clearance=clearance)
        return _Replayed(disc, "the real outline", replay)
    contour = _contour(disc, flank, Path(file), arguments)
    corner = max(math.radians(arguments.corner), CORNER)
    replay = replay_contour(disc.cam.disc.pitch_curve, contour, flank, step=angle, corner=corner)
    return _Replayed(disc, Path(file).name, replay)


def _scale(design: Design) -> Scale:
    if design.cam.lift_unit == "rad":
        return Scale("deg", math.degrees(1.0))
    return Scale(design.scene.unit, 1.0 / MM_PER[design.scene.unit])


def _contour(disc: Product, flank: Flank, file: Path, arguments: argparse.Namespace) -> Contour:
    """The contour of the file whose area is nearest to that of the flank."""
    from importlib.metadata import entry_points

    from camgeo.contour.simple import crossing

    names = sorted(entry_points(group=READERS).names)
    kind = file.suffix.removeprefix(".").lower()
    if kind not in names:
        endings = ", ".join(f".{name}" for name in names)
        raise SceneError([Fault("CONTOUR", str(file), f"the name must end in one of {endings}")])
    reader: Reader = entry_points(group=READERS)[kind].load()
    try:
        data = file.read_bytes()
    except OSError as error:
        raise SceneError(
            [Fault("CONTOUR", str(file), f"cannot be read: {error.strerror or error}")]
        ) from error
    found = reader.read(
        data, file.name, layer=arguments.layer, unit=arguments.unit, gap=arguments.gap
    )
    points = disc.pictured.curve(flank, np.linspace(0.0, 2.0 * math.pi, OUTLINE_SAMPLES))
    x, y = points.T
    area = abs(0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))
    chosen = min(found, key=lambda contour: abs(contour.area - area))
    if len(found) > 1:
        tell(f"{file.name}: {len(found)} contours, taken is that of {chosen.area:.6g} mm^2")
    place = crossing(chosen)
    if place is not None:
        message = f"crosses itself ({place}): no disc has this outline"
        raise SceneError([Fault("CONTOUR", str(file), message)])
    return chosen


# Files --------------------------------------------------------------------------------------------


def _write(
    disc: Product,
    replay: Replay,
    scale: Scale,
    step: Decimal,
    what: str,
    arguments: argparse.Namespace,
    pair: tuple[Replay, Replay] | None,
) -> None:
    target = Path(arguments.output)
    if target.suffix == ".csv":
        table = _table(replay, scale, step, pair)
        data, told = table.csv().encode(), f"{len(table.values)} rows"
    else:
        from camgeo.figure import replay as picture

        figure = picture.figure(
            replay,
            title=f"{disc.name}: replay, {what}",
            unit=scale.unit,
            scale=scale.factor,
            joints=disc.cam.drive.joints,
        )
        data = drawn(figure, target.suffix)
        told = "lift, velocity, acceleration"
    write_told([(target, data, told)], force=arguments.force)


def _table(
    replay: Replay, scale: Scale, step: Decimal, pair: tuple[Replay, Replay] | None
) -> Table:
    """One row for every `step` degrees, right-hand values; of a pair with the play between them."""
    degrees = cam_angles(step)
    phi: FloatArray = np.radians(degrees)
    demanded = replay.course.motion.jet(phi, "right", 2) * scale.factor
    actual = replay.course.jet(phi) * scale.factor
    unit = scale.unit
    columns = {
        "phi [deg]": degrees,
        f"s demanded [{unit}]": demanded[0],
        f"s [{unit}]": actual[0],
        f"difference [{unit}]": actual[0] - demanded[0],
        f"s' [{unit}/rad]": actual[1],
        f"s'' [{unit}/rad^2]": actual[2],
        f"s' demanded [{unit}/rad]": demanded[1],
        f"s'' demanded [{unit}/rad^2]": demanded[2],
    }
    if pair is not None:
        from camgeo.outline.replay_result import play

        columns[f"play [{unit}]"] = play(*pair, phi) * scale.factor
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))
