"""`camgeo replay`: what the follower does on the real disc, or on any contour from a file."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np

from camgeo.cli.command import FINE, Subparsers, identity, new_parser, print_json, tell
from camgeo.cli.plot import RENDERERS, SUFFIXES
from camgeo.contour.contour import Contour
from camgeo.design import Design
from camgeo.errors import Fault, SceneError
from camgeo.files.table import Table
from camgeo.files.value_table import cam_angles
from camgeo.motion.time_course import in_time
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.outline.replay import CORNER, Contact, replay_contour, replay_outline
from camgeo.outline.replay_result import Replay
from camgeo.scene.load import load_scene
from camgeo.units import LengthUnit

READERS: Final = "camgeo.readers"
"""Entry points that read contours from files, by what the file's name ends in without the dot."""

RENDERER: Final = "replay"
"""Entry point of the group `camgeo.renderers` that draws a replay."""

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


@dataclass(frozen=True, slots=True)
class Scale:
    """The unit in which the lift is told, and how many of it are in 1 mm or rad."""

    unit: str
    factor: float


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "replay",
        "roll the roller over the real outline, or over a contour from a file: lift, velocity,"
        " acceleration, shocks, against what is demanded",
        "camgeo replay fixtures/scenes/setzhub.toml\n"
        "  camgeo replay fixtures/scenes/setzhub.toml out/setzhub.dxf -o ripple.png\n"
        "  camgeo replay my-cam.toml measured.csv --unit mm --json",
    )
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    parser.add_argument(
        "contour",
        metavar="CONTOUR",
        nargs="?",
        help="drawing (DXF), or vertices (CSV: x, y, bulge), in the axes of the scene's cam;"
        " default the scene's real outline",
    )
    parser.add_argument("--layer", metavar="NAME", help="layer of the drawing; default CUT, or all")
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of CONTOUR, if it does not say one"
    )
    parser.add_argument(
        "--gap", metavar="MM", type=float, default=GAP,
        help=f"end points of a drawing up to this far apart are joined; default {GAP:g}",
    )  # fmt: skip
    parser.add_argument(
        "--corner", metavar="DEG", type=float, default=FLAT,
        help=f"corners of CONTOUR up to this angle count as none; default {FLAT:g}",
    )  # fmt: skip
    parser.add_argument(
        "--flank", choices=("inner", "outer"), help="flank of the roller; default the scene's"
    )
    parser.add_argument("--step", metavar="DEG", help=f"step of the cam angle; default {STEP}")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "-o", metavar="FILE", dest="output",
        help=f"file to write: a table (.csv) or a picture ({', '.join(SUFFIXES)})",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="write over an existing file")
    parser.set_defaults(run=partial(run, parser))


def run(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    """Replay, and print or write what comes of it."""
    step = _step(parser, arguments.step)
    for option in ("gap", "corner"):
        value = getattr(arguments, option)
        if not (math.isfinite(value) and value >= 0.0):
            parser.error(f"argument --{option}: must be a number from 0 on")
    target = None if arguments.output is None else Path(arguments.output)
    if target is not None and target.suffix not in (".csv", *SUFFIXES):
        allowed = ", ".join((".csv", *SUFFIXES))
        parser.error(f"argument -o: {arguments.output!r} must end in one of {allowed}")
    design = Design(load_scene(arguments.scene))
    flank: Contact = arguments.flank or ("outer" if design.contact == "outer" else "inner")
    angle = math.radians(float(step))
    if arguments.contour is None:
        source = "the real outline"
        outline = design.outline(flank)
        replay = replay_outline(design.pitch_curve, outline.path, step=angle)
    else:
        source = Path(arguments.contour).name
        contour = _contour(design, flank, arguments)
        corner = max(math.radians(arguments.corner), CORNER)
        replay = replay_contour(design.pitch_curve, contour, flank, step=angle, corner=corner)
    scale = _scale(design)
    if target is not None:
        _write(target, design, replay, scale, step, f"{flank} flank, {source}", arguments)
    record = _record(design, replay, scale)
    if arguments.json:
        print_json({**identity(design), "contour": source, "flank": flank, **record})
    else:
        print(f"{design.name}: the roller on {source}, {flank} flank")
        print("\n".join(_lines(record)))
    return FINE


def _step(parser: argparse.ArgumentParser, text: str | None) -> Decimal:
    if text is None:
        return STEP
    try:
        step = Decimal(text)
    except InvalidOperation:
        parser.error(f"argument --step: {text!r} is no number of degrees")
    if not (step.is_finite() and SMALLEST_STEP <= step <= LARGEST_STEP):
        parser.error(
            f"argument --step: {text} degrees; from {SMALLEST_STEP} to {LARGEST_STEP} are allowed"
        )
    return step


def _scale(design: Design) -> Scale:
    if design.lift_unit == "rad":
        return Scale("deg", math.degrees(1.0))
    return Scale(design.unit, 1.0 / design.millimetres)


def _contour(design: Design, flank: Contact, arguments: argparse.Namespace) -> Contour:
    """The contour of the file whose area is nearest to that of the flank."""
    from importlib.metadata import entry_points

    from camgeo.contour.simple import crossing

    file = Path(arguments.contour)
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
    points = design.curve(flank, np.linspace(0.0, 2.0 * math.pi, OUTLINE_SAMPLES))
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


# What is told -------------------------------------------------------------------------------------


def _record(design: Design, replay: Replay, scale: Scale) -> dict[str, Any]:
    """All that is told, in the unit of the scene; angles in degrees, derivatives per rad."""

    def at(extreme: Extreme) -> dict[str, float]:
        return {
            "value": extreme.value * scale.factor + 0.0,
            "cam_angle_deg": math.degrees(extreme.place),
        }

    falls = bool(len(replay.drops))
    peaks = {
        "velocity": (replay.velocity, replay.demanded_velocity),
        "acceleration": (replay.acceleration, replay.demanded_acceleration),
    }
    record: dict[str, Any] = {
        "unit": scale.unit,
        "of": "rocker" if design.has_linkage else "follower",
        "lost_stroke": at(replay.largest_loss),
        "lift_error": at(replay.largest_error),
    }
    for name, (actual, demanded) in peaks.items():
        # Where the roller falls off an edge the velocity has no bound.
        told = {} if falls else at(actual)
        record[name] = {**told, "demanded": demanded * scale.factor}
    record["ripple"] = None if falls else replay.ripple
    record["ripple_cam_angle_deg"] = math.degrees(replay.largest_acceleration_error.place)
    jump, drop = replay.shocks.largest(), replay.drops.largest()
    record["shocks"] = {
        "count": len(replay.shocks),
        "largest": None if jump is None else at(jump),
        "share_of_velocity": replay.largest_shock,
    }
    record["drops"] = {
        "count": len(replay.drops),
        "largest": None if drop is None else at(drop),
    }
    if design.time_course is not None and not falls:
        record["in_time"] = _in_time(design, replay, scale)
    return record


def _in_time(design: Design, replay: Replay, scale: Scale) -> dict[str, float]:
    """Largest velocity and acceleration per second, actual and demanded at the samples."""
    course = design.time_course
    assert course is not None  # asked before
    out = {}
    for name, jet in (("actual", replay.actual), ("demanded", replay.demanded)):
        full = np.vstack((jet, np.zeros_like(jet[:1])))
        timed = in_time(full, course, replay.phi)
        out[f"{name}_velocity"] = float(np.max(np.abs(timed[1]))) * scale.factor
        acceleration = np.abs(timed[2])[replay.smooth]
        out[f"{name}_acceleration"] = float(np.max(acceleration)) * scale.factor
    return out


def _lines(record: dict[str, Any]) -> list[str]:
    unit = record["unit"]
    lines = [
        f"{'lost stroke':22}{_at(record['lost_stroke'], unit)}",
        f"{'lift error':22}{_at(record['lift_error'], unit)}",
    ]
    for name, per in (("velocity", "rad"), ("acceleration", "rad^2")):
        told = record[name]
        actual = _at(told, f"{unit}/{per}") if "value" in told else "unbounded"
        lines.append(f"{name:22}{actual}; demanded {told['demanded']:.6g}")
    if record["ripple"] is not None:
        place = record["ripple_cam_angle_deg"]
        lines.append(
            f"{'ripple':22}{_percent(record['ripple'])} of the demanded peak acceleration,"
            f" at cam angle {place:.6g} deg"
        )
    shocks, drops = record["shocks"], record["drops"]
    text = "none"
    if shocks["largest"] is not None:
        text = f"{shocks['count']}, the largest {_at(shocks['largest'], f'{unit}/rad')}"
        if shocks["share_of_velocity"] is not None:
            text += f", {_percent(shocks['share_of_velocity'])} of the demanded peak velocity"
    lines.append(f"{'shocks':22}{text}")
    if drops["largest"] is not None:
        lines.append(
            f"{'falls off an edge':22}{drops['count']} times, {_at(drops['largest'], unit)}"
        )
    if "in_time" in record:
        timed = record["in_time"]
        for name, per in (("velocity", "s"), ("acceleration", "s^2")):
            lines.append(
                f"{name + ' in time':22}{timed[f'actual_{name}']:.6g} {unit}/{per}; demanded"
                f" {timed[f'demanded_{name}']:.6g}"
            )
    return lines


def _at(told: dict[str, float], unit: str) -> str:
    return f"{told['value']:.6g} {unit} at cam angle {told['cam_angle_deg']:.6g} deg"


def _percent(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.0f} %" if percent >= 100.0 else f"{percent:.3g} %"


# Files --------------------------------------------------------------------------------------------


def _write(
    target: Path,
    design: Design,
    replay: Replay,
    scale: Scale,
    step: Decimal,
    what: str,
    arguments: argparse.Namespace,
) -> None:
    from importlib.metadata import entry_points

    from camgeo.files.transaction import write_set

    if target.suffix == ".csv":
        table = _table(replay, scale, step)
        data, told = table.csv().encode(), f"{len(table.values)} rows"
    else:
        render: Callable[..., bytes] = entry_points(group=RENDERERS)[RENDERER].load()
        data = render(
            replay,
            title=f"{design.name}: replay, {what}",
            unit=scale.unit,
            scale=scale.factor,
            joints=design.joints,
            suffix=target.suffix,
        )
        told = "lift, velocity, acceleration"
    write_set(target.parent, {target.name: data}, force=arguments.force)
    tell(f"{target}: {told}")


def _table(replay: Replay, scale: Scale, step: Decimal) -> Table:
    """One row for every `step` degrees, right-hand values."""
    degrees = cam_angles(step)
    phi: FloatArray = np.radians(degrees)
    demanded = replay.course.motion.jet(phi, "right", 2) * scale.factor
    actual = replay.course.jet(phi) * scale.factor
    unit = scale.unit
    names = (
        "phi [deg]",
        f"s demanded [{unit}]",
        f"s [{unit}]",
        f"difference [{unit}]",
        f"s' [{unit}/rad]",
        f"s'' [{unit}/rad^2]",
        f"s' demanded [{unit}/rad]",
        f"s'' demanded [{unit}/rad^2]",
    )
    columns = (
        degrees,
        demanded[0],
        actual[0],
        actual[0] - demanded[0],
        actual[1],
        actual[2],
        demanded[1],
        demanded[2],
    )
    return Table(names, np.column_stack(columns))
