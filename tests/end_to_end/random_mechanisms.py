"""Scenes of every follower and linkage made up at random, half of them near something critical."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from random import Random
from typing import Any, Final

import numpy as np

from tests.end_to_end.independent import LAWS, Model

Values = dict[str, Any]

FOLLOWERS: Final = (
    "translating-roller", "oscillating-roller", "translating-flat", "oscillating-flat",
)  # fmt: skip
LINKAGES: Final = (None, "slider-crank", "four-bar")

KINDS: Final = tuple(
    (follower, linkage)
    for follower in FOLLOWERS
    for linkage in LINKAGES
    if linkage != "four-bar" or follower.startswith("oscillating")
)
"""A four-bar drives rockers alone."""

NEAR: Final = ("dead-centre", "cusp", "joint")


def drawn(number: int) -> Values:
    """The scene of a number; every second one is near something critical."""
    rng = Random(number)
    follower, linkage = KINDS[number % len(KINDS)]
    near = NEAR[(number // (2 * len(KINDS))) % len(NEAR)] if (number // len(KINDS)) % 2 else None
    if near == "dead-centre" and linkage is None:
        near = "cusp"
    while True:
        values = _values(rng, number, follower, linkage, near)
        if near is None or _moved_near(rng, values, near):
            return values


def _values(
    rng: Random, number: int, follower: str, linkage: str | None, near: str | None
) -> Values:
    """A scene whose linkage closes and whose rocker reaches its base circle."""
    while True:
        values: Values = {
            "camgeo": 1,
            "name": f"random-{number}",
            "cam": {"rotation": rng.choice(("cw", "ccw")), "speed": rng.choice((30, 120, 600))},
            "follower": _follower(rng, follower),
        }
        if linkage is not None:
            values["linkage"] = _linkage(rng, linkage)
            values["follower"].pop("direction", None)
        values["motion"] = _motion(rng, _stroke(rng, follower, linkage), joints=near == "joint")
        model = Model(values)
        try:
            if model.spare <= (0.5 if near is None else -40.0):
                continue
            if model.spare > 0.0 and not _reaches(model):
                continue
        except ValueError:  # of an arccosine: the rocker does not reach the base circle
            continue
        if values["follower"].get("contact", "inner") != "inner":
            values["part"] = {"rim": 1000}
        return values


def _reaches(model: Model) -> bool:
    """Whether the follower stays on its side of the cam axis."""
    phi = np.linspace(0.0, 2.0 * math.pi, 721)
    if model.is_flat:
        distance, _ = model.face(phi)
        return float(np.min(distance)) > 1.0
    centre = model.centre(phi)
    if not model.rocks:
        guide = math.radians(model.follower.get("guide_angle", 90.0))
        return float(np.min(np.real(centre * np.exp(-1j * guide)))) > 2.0
    pivot = complex(*model.follower["pivot"])
    beside = np.imag(np.conj(-pivot) * (centre - pivot)) / abs(pivot) / model.follower["arm"]
    return float(np.min(np.abs(beside))) > 0.05 and np.ptp(np.sign(beside)) == 0.0


def _round(value: float, digits: int = 3) -> float:
    return round(value, digits)


def _follower(rng: Random, kind: str) -> Values:
    found: Values = {"kind": kind, "base_radius": _round(rng.uniform(20.0, 90.0))}
    if kind.startswith("translating"):
        found["guide_angle"] = rng.choice((90.0, _round(rng.uniform(-180.0, 180.0))))
    else:
        away, place = rng.uniform(60.0, 160.0), rng.uniform(-math.pi, math.pi)
        found["pivot"] = [_round(away * math.cos(place)), _round(away * math.sin(place))]
        found["arm_side"] = rng.choice(("cw", "ccw"))
    if kind == "oscillating-roller":
        found["arm"] = _round(rng.uniform(50.0, 150.0))
    if kind == "oscillating-flat":
        found["face_offset"] = _round(rng.uniform(-15.0, 25.0))
    if kind.endswith("roller"):
        found["roller_radius"] = _round(rng.uniform(3.0, 0.5 * found["base_radius"]))
        found["contact"] = rng.choice(("inner", "inner", "outer", "groove"))
        if kind == "translating-roller":
            found["offset"] = _round(rng.uniform(-0.4, 0.4) * found["base_radius"])
    found["direction"] = rng.choice(("outward", "outward", "inward"))
    return found


def _linkage(rng: Random, kind: str) -> Values:
    found: Values = {
        "kind": kind,
        "crank": _round(rng.uniform(40.0, 120.0)),
        "coupler": _round(rng.uniform(60.0, 180.0)),
        "branch": rng.choice(("cw", "ccw")),
    }
    if kind == "four-bar":
        found["lever"] = _round(rng.uniform(40.0, 120.0))
        found["shaft"] = [_round(rng.uniform(-150.0, 150.0)), _round(rng.uniform(-150.0, 150.0))]
        found["lever_angle"] = _round(rng.uniform(-180.0, 180.0))
        found["lever_sense"] = rng.choice(("cw", "ccw"))
        return found
    found["crank_deflection"] = _round(rng.uniform(-60.0, 60.0))
    found["crank_leans"] = rng.choice(("away", "toward"))
    found["slider_side"] = rng.choice(("left", "right"))
    found["stroke_direction"] = rng.choice(("left", "right"))
    return found


def _stroke(rng: Random, follower: str, linkage: str | None) -> float:
    """Largest position, in the unit of the scene."""
    length = (linkage is None) == follower.startswith("translating") and linkage != "four-bar"
    return _round(rng.uniform(4.0, 40.0 if length else 35.0), 2)


def _motion(rng: Random, stroke: float, *, joints: bool) -> list[Values]:
    """Moves from rest to rest with dwells; with `joints` many of them, and dwells of 0."""
    count = rng.randint(8, 40) if joints else rng.randint(2, 6)
    weights = [rng.uniform(0.5, 3.0) for _ in range(count)]
    spans = [round(360.0 * weight / sum(weights), 3) for weight in weights]
    spans[-1] = round(360.0 - sum(spans[:-1]), 3)
    segments: list[Values] = []
    level = 0.0
    for number, span in enumerate(spans):
        last = number == count - 1
        if (last and level == 0.0) or (not last and rng.random() < 0.35):
            segments.append({"dwell": span})
            continue
        if last:
            level = 0.0
        elif count < 8:
            level = _round(rng.uniform(0.0, 1.0) * stroke)
        else:  # a ramp: short moves with large strokes would undercut everywhere
            share = 0.5 * (1.0 - math.cos(2.0 * math.pi * number / count))
            level = _round(share * stroke * rng.uniform(0.98, 1.02))
        segments.append({"law": rng.choice(tuple(LAWS)), "span": span, "to": level})
        if joints and rng.random() < 0.2 and len(segments) < 50 - count + number:
            segments.append({"dwell": 0})
    return segments


# Near something critical --------------------------------------------------------------------------


def _moved_near(rng: Random, values: Values, near: str) -> bool:
    """Change one size so that the scene is next to where it fails; False if it cannot."""
    away = rng.choice((-1.0, 1.0)) * 10.0 ** -rng.uniform(1.5, 16.0)
    if near == "dead-centre":
        held = rng.random() < 0.3
        return _by(
            values,
            ("linkage", "coupler"),
            lambda model: model.leverage if held else model.spare,
            away,
        )
    if values["follower"]["kind"].endswith("flat"):
        return _by(values, ("follower", "base_radius"), lambda model: model.face_margin, away)
    side = 1 if values["follower"]["contact"] == "outer" else -1
    return _by(values, ("follower", "roller_radius"), lambda model: model.cusp_margin(side), away)


def _by(
    values: Values, key: tuple[str, str], margin: Callable[[Model], float], away: float
) -> bool:
    """Set a key to (1 + away) times the value at which the margin vanishes, found by bisection."""
    table, name = key

    def at(value: float) -> float:
        edited = copy.deepcopy(values)
        edited[table][name] = value
        try:
            model = Model(edited)
            found = margin(model)
            return found if math.isfinite(found) else -1.0
        except ValueError:
            return -1.0

    start = float(values[table][name])
    here = at(start)
    for factor in (0.5, 0.75, 1.25, 1.5, 2.0, 3.0):
        if (at(start * factor) > 0.0) != (here > 0.0):
            break
    else:
        return False
    low, high = start, start * factor
    for _ in range(52):
        middle = 0.5 * (low + high)
        if (at(middle) > 0.0) == (here > 0.0):
            low = middle
        else:
            high = middle
    values[table][name] = low * (1.0 + away)
    try:
        model = Model(values)
        return model.spare <= 0.0 or _reaches(model)
    except ValueError:
        return False
