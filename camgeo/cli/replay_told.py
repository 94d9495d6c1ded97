"""What `camgeo replay` says: a replay as a record for JSON, and in lines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.motion.time_course import TimeCourse, in_time
from camgeo.numeric.extremes import Extreme
from camgeo.outline.replay_result import Replay
from camgeo.units import TURN

TOUCHING: Final = 1e-9
"""Rollers that are squeezed by up to this [mm] touch: rounding."""


@dataclass(frozen=True, slots=True)
class Scale:
    """The unit in which the lift is told, and how many of it are in 1 mm or rad."""

    unit: str
    factor: float


def record_of(cam: Cam, replay: Replay, scale: Scale) -> dict[str, Any]:
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
        "of": "rocker" if cam.drive.linkage is not None and cam.lift_unit == "rad" else "follower",
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
    course = cam.drive.time_course
    if course is not None and not falls:
        record["in_time"] = _in_time(course, replay, scale)
    return record


def _in_time(course: TimeCourse, replay: Replay, scale: Scale) -> dict[str, float]:
    """Largest velocity and acceleration per second, actual and demanded at the samples."""
    out = {}
    for name, jet in (("actual", replay.actual), ("demanded", replay.demanded)):
        full = np.vstack((jet, np.zeros_like(jet[:1])))
        timed = in_time(full, course, replay.phi)
        out[f"{name}_velocity"] = float(np.max(np.abs(timed[1]))) * scale.factor
        acceleration = np.abs(timed[2])[replay.smooth]
        out[f"{name}_acceleration"] = float(np.max(acceleration)) * scale.factor
    return out


def closing_of(cam: Cam, main: Replay, other: Replay) -> dict[str, Any]:
    """Play and squeeze of a conjugate pair, as way of the main roller [mm]."""
    from camgeo.outline.replay_result import closing_error  # few cams are pairs

    found = closing_error(main, other)
    scale = abs(cam.follower.reach)

    def at(extreme: Extreme) -> dict[str, float]:
        place = math.degrees(extreme.place % TURN)
        return {"value": scale * extreme.value + 0.0, "cam_angle_deg": place}

    return {"unit": "mm", "largest_play": at(found.highest), "smallest_play": at(found.lowest)}


def closing_lines(closing: dict[str, Any]) -> list[str]:
    """Play, and squeeze where it is negative."""
    lines = []
    for name in ("largest play", "smallest play"):
        told = closing[name.replace(" ", "_")]
        tail = ": the rollers are squeezed there" if told["value"] < -TOUCHING else ""
        lines.append(f"{name:22}{_at(told, 'mm')}, as way of the main roller{tail}")
    return lines


def lines_of(record: dict[str, Any]) -> list[str]:
    """What the follower does, a line each."""
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
