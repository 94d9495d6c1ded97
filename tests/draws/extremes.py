"""The extremes of random lift tables and plans, against formulas on a grid of 0.002 degree.

The lift is camgeo's, because two solutions of one spline differ by more than is asked here; what
follows from it has formulas of its own. No value on the grid may be beyond an extreme that is told
by more than 1e-9 of its size, nor may the value differ by more at the cam angle that is told; and
nothing that the grid breaks may be ok. For `check`, for `sweep` and for the sizes of `size`.
"""

from __future__ import annotations

import math
import random
import sys
import tempfile
from argparse import Namespace
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import tomlkit

import camgeo
from camgeo.app.answers.size import size
from camgeo.errors import CamgeoError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.studies.sweep.family import Family, Listed, Variable
from camgeo.studies.sweep.sweep import sweep
from tests.draws.run import Case, parser_of, run_cases

CLOSE: Final = 1e-9
STEP: Final = 0.002
BLOCK: Final = 8192
LAWS: Final = (
    "polynomial-345", "polynomial-4567", "modified-sine", "modified-trapezoid", "inclined-sine",
    "scca", "simple-sine", "quadratic-parabola", "polynomial-7",
)  # fmt: skip
KINDS: Final = (
    "translating-roller", "oscillating-roller", "translating-flat", "oscillating-flat",
)  # fmt: skip
ASKED: Final = ("transmission-angle", "radius-ratio-inner", "max:kappa", "min:kappa", "min:mu")
SIZED: Final = 5
"""One case of so many is sized too."""


@dataclass(frozen=True)
class Told:
    """An extreme that is told: its name, its value, where [rad], and whether it is the least one.

    `ok` is whether it is told to be within its limit; `limit` is None without one.
    """

    name: str
    value: float
    place: float | None
    least: bool
    ok: bool = False
    limit: float | None = None


def follower(source: random.Random, kind: str, lift: float) -> dict[str, Any]:
    """A follower of a kind whose stroke is `lift` [mm]."""
    base = source.uniform(1.5, 5.0) * lift + 15.0
    own: dict[str, Any] = {"kind": kind, "base_radius": base}
    if kind == "translating-flat":
        return own
    if kind == "oscillating-flat":
        own["face_offset"] = source.uniform(-0.3, 0.3) * base
        own["pivot"] = [source.uniform(1.2, 2.5) * (base - own["face_offset"]), 0.0]
        own["arm_side"] = source.choice(["ccw", "cw"])
        return own
    own["roller_radius"] = source.uniform(0.05, 0.35) * base
    if kind == "translating-roller":
        own["offset"] = source.uniform(-0.4, 0.4) * base
        return own
    arm = source.uniform(1.2, 2.5) * base
    own["arm"], own["pivot"] = arm, [math.hypot(arm, base) * source.uniform(0.8, 1.1), 0.0]
    own["arm_side"] = source.choice(["ccw", "cw"])
    return own


def scene_of(source: random.Random, kind: str, motion: list[dict[str, Any]], lift: float) -> Any:
    """The values of a scene with that motion."""
    limits = {
        "transmission_angle": source.uniform(20.0, 60.0),
        "radius_ratio": source.uniform(0.3, 1.0),
    }
    return {
        "camgeo": 1,
        "name": "extremes",
        "cam": {"rotation": source.choice(["cw", "ccw"])},
        "follower": follower(source, kind, lift),
        "motion": motion,
        "limits": limits if kind.endswith("roller") else {},
    }


def table(source: random.Random, kind: str) -> tuple[Any, str]:
    """A scene with a lift table, and the table: equal rows, some noise, perhaps a bad row."""
    step = source.choice([0.1, 0.25, 0.5, 1.0, 2.0, 5.0])
    lift = source.uniform(5.0, 30.0)
    phi = np.arange(round(360.0 / step)) * step
    width, middle = source.uniform(90.0, 175.0), source.uniform(120.0, 240.0)
    away = np.clip(np.abs(phi - middle) / width, 0.0, 1.0)
    values = lift * (1.0 - away**3 * (10.0 - 15.0 * away + 6.0 * away**2))
    noise = source.choice([0.0, 10.0 ** source.uniform(-5.0, -2.3)]) * min(1.0, step**2)
    values += np.array([source.uniform(-noise, noise) for _ in phi])
    if source.random() < 0.7:  # as much as bends the curve by about as much as it is
        row = source.randrange(1, len(phi))
        values[row] += source.choice([-1.0, 1.0]) * 0.02 * step**2 * source.uniform(0.0, 1.0)
    values -= values[0]
    size = 1.0
    if kind.startswith("oscillating"):
        size = math.radians(1.0) * 60.0
    rows = [f"{a:.6g},{b / size:.7f}" for a, b in zip(phi, values, strict=True)]
    text = "\n".join(["angle,lift", *rows, "360,0"]) + "\n"
    motion = [{"law": "table", "span": 360, "file": "lift.csv"}]
    return scene_of(source, kind, motion, lift), text


def plan(source: random.Random, kind: str) -> Any:
    """A scene with two to four moves by laws, and dwells between some of them."""
    moves = source.choice([2, 2, 3, 4])
    spans = [source.uniform(0.5, 2.0) for _ in range(2 * moves)]
    dwells = [source.random() < 0.6 for _ in range(moves)]
    total = sum(spans[:moves]) + sum(s for s, d in zip(spans[moves:], dwells, strict=True) if d)
    lift, motion, left = source.uniform(5.0, 30.0), [], 360_000
    size = math.radians(1.0) * 60.0 if kind.startswith("oscillating") else 1.0
    for number in range(moves):
        to = 0.0 if number == moves - 1 else source.uniform(0.3, 1.0) * lift / size
        span = round(360_000 * spans[number] / total)
        rest = round(360_000 * spans[moves + number] / total) if dwells[number] else 0
        if number == moves - 1:
            span = left - rest
        left -= span + rest
        motion.append({"law": source.choice(LAWS), "span": span / 1000.0, "to": round(to, 4)})
        if rest:
            motion.append({"dwell": rest / 1000.0})
    return scene_of(source, kind, motion, lift)


def jet_of(design: camgeo.Design, phi: FloatArray, side: Any = "right") -> FloatArray:
    """(4, n) the lift and its derivatives [mm or rad per rad^k]."""
    motion: Any = design.cam.drive.motion
    return np.concatenate(
        [motion.jet(phi[k : k + BLOCK], side)[:4] for k in range(0, len(phi), BLOCK)], axis=1
    )


def centres(values: Any, jet: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """R_0, R_1, R_2 of the roller's centre seen from the cam, and the way it is moved; see below.

    With W the centre in the frame, that of the cam is Z = W exp(-i sense phi).
    """
    own, sense = values["follower"], 1.0 if values["cam"]["rotation"] == "ccw" else -1.0
    s, s1, s2, _ = jet
    if own["kind"] == "translating-roller":
        base, offset = own["base_radius"], own["offset"]
        w, w1, w2 = offset + 1j * (math.sqrt(base**2 - offset**2) + s), 1j * s1, 1j * s2
        way = np.full(len(s), 1j)
    else:
        pivot, arm = complex(*own["pivot"]), own["arm"]
        side = 1.0 if own["arm_side"] == "ccw" else -1.0
        gap = abs(pivot)
        start = math.acos((gap**2 + arm**2 - own["base_radius"] ** 2) / (2.0 * gap * arm))
        spoke = arm * np.exp(1j * (np.angle(-pivot) + side * (start + s)))
        w, w1 = pivot + spoke, 1j * side * s1 * spoke
        w2 = (1j * side * s2 - s1**2) * spoke
        way = 1j * spoke / arm
    return w1 - 1j * sense * w, w2 - 2j * sense * w1 - w, way


def on_face(own: Any, sense: float, jet: FloatArray) -> dict[str, FloatArray]:
    """Radius of curvature [mm] and transmission angle [deg] under a face on a rocker.

    From the distance h of the face from the cam axis as a function of the angle theta of its normal
    in the cam: the contact is (h + i dh/dtheta) exp(i theta), the radius h + d2h/dtheta2.
    """
    s, s1, s2, _ = jet
    pivot, side = complex(*own["pivot"]), 1.0 if own["arm_side"] == "ccw" else -1.0
    start = math.acos((own["base_radius"] - own["face_offset"]) / abs(pivot))
    normal = np.exp(1j * (np.angle(pivot) + side * (s - start)))
    nu1, nu2 = side * s1, side * s2
    theta1 = nu1 - sense
    along, across = np.real(np.conj(normal) * pivot), np.real(np.conj(1j * normal) * pivot)
    h, h1 = along + own["face_offset"], across * nu1
    h2 = across * nu2 - along * nu1**2
    slope = h1 / theta1
    radius = h + (h2 * theta1 - h1 * nu2) / theta1**3
    way = 1j * ((h + 1j * slope) * normal - pivot)
    moved = np.conj(normal) * way
    angle = np.degrees(np.arctan2(np.abs(moved.real), np.abs(moved.imag)))
    return {"convexity": radius, "turn": 1.0 - sense * nu1, "transmission-angle": angle}


def quantities(values: Any, jet: FloatArray) -> dict[str, FloatArray]:
    """What is told of a cam, at the cam angles of a `jet` (4, n)."""
    own, sense = values["follower"], 1.0 if values["cam"]["rotation"] == "ccw" else -1.0
    unit = 1.0 if own["kind"].startswith("translating") else math.degrees(1.0)
    rates = {name: unit * np.abs(jet[order]) for order, name in enumerate(RATES, start=1)}
    if own["kind"] == "translating-flat":
        return {**rates, "convexity": own["base_radius"] + jet[0] + jet[2]}
    if own["kind"] == "oscillating-flat":
        return {**rates, **on_face(own, sense, jet)}
    first, second, way = centres(values, jet)
    kappa = -sense * np.imag(np.conj(first) * second) / np.abs(first) ** 3
    across = np.conj(1j * first / np.abs(first)) * way
    angle = np.degrees(np.arctan2(np.abs(across.real), np.abs(across.imag)))
    return {
        **rates,
        "transmission-angle": angle,
        "radius-ratio-inner": own["roller_radius"] * kappa,
        "kappa": kappa,
    }


LEAST: Final = ("transmission-angle", "convexity", "turn")
RATES: Final = ("largest-velocity", "largest-acceleration", "largest-jerk")


def name_of(found: camgeo.Finding) -> str:
    """The quantity of a finding: a face that turns back in the cam has no radius."""
    return "turn" if found.name == "convexity" and found.unit != "mm" else found.name


def checked(design: camgeo.Design) -> Iterator[Told]:
    """What `check` tells."""
    for found in design.findings:
        if found.name in (*LEAST, *RATES, "radius-ratio-inner") and found.value:
            least, ok = found.name in LEAST, found.severity == "ok"
            value = abs(found.value) if found.name in RATES else found.value
            yield Told(name_of(found), value, found.cam_angle, least, ok, found.limit)


def swept(design: camgeo.Design) -> Iterator[Told]:
    """What `sweep` tells of the design, as one of two that are computed at once."""
    base = float(design.scene.values["follower"]["base_radius"])
    family = Family(
        design.scene,
        (Variable(("follower.base_radius",), Listed(((base * 1.01,), (base,)))),),
    )
    flat = design.scene.values["follower"]["kind"].endswith("flat")
    asked = ("convexity",) if flat else ASKED
    row = [*sweep(family, asked).rows][-1]
    for name, value in zip(asked, row.values, strict=True):
        if isinstance(value, float):
            kind, _, column = name.rpartition(":")
            own = {"mu": "transmission-angle"}.get(column, column)
            if own == "convexity":
                own = next(name_of(each) for each in design.findings if each.name == own)
            yield Told(own, value, None, kind == "min" or (not kind and name in LEAST))


def misses(
    values: Any, design: camgeo.Design, tolds: list[Told], step: float = STEP
) -> Iterator[str]:
    """What is wrong with what is told, on a grid of `step` degrees."""
    phi = np.radians(np.arange(round(360.0 / step)) * step)
    on_grid = quantities(values, jet_of(design, phi))
    for told in tolds:
        if told.name not in on_grid:  # the angle of a flat face on a guide is 90 degrees
            continue
        grid, size = on_grid[told.name], CLOSE * abs(told.value)
        k = int(np.argmin(grid) if told.least else np.argmax(grid))
        beyond = told.value - grid[k] if told.least else grid[k] - told.value
        where = f"{math.degrees(phi[k]):.3f} deg"
        if beyond > size:
            yield f"{told.name} {told.value!r}, but {grid[k]!r} at {where}"
        if told.place is not None:
            at = np.array([told.place])
            sides = ("right", "left")
            there = [quantities(values, jet_of(design, at, s))[told.name][0] for s in sides]
            if min(abs(each - told.value) for each in there) > size:
                yield f"{told.name} {told.value!r} at {told.place!r} rad, but there {there[0]!r}"
        if told.ok and told.limit is not None:
            over = told.limit - grid[k] if told.least else grid[k] - told.limit
            if over > CLOSE * abs(told.limit):
                yield f"{told.name} is ok, but {grid[k]!r} at {where}, limit {told.limit!r}"


def sized(values: Any, design: camgeo.Design) -> Iterator[str]:
    """What is wrong with the sizes that `size` finds."""
    flat = values["follower"]["kind"].endswith("flat")
    found = size(design, radius_of_curvature=1.0) if flat else size(design)
    if found.best.sizing.answer is None:
        return
    answer = found.best.sizing.answer
    radius = answer.radius_of_curvature
    own: Any = answer.follower
    made = {**values["follower"], "base_radius": own.base_radius}
    if "offset" in made:
        made["offset"] = own.offset
    elif "pivot" in made:
        made["pivot"] = [own.pivot.real, own.pivot.imag]
        made["arm_side"] = "ccw" if own.arm_side > 0 else "cw"
    if flat:
        assert radius is not None
        tolds = [Told("convexity", radius.value, radius.place, least=True)]
    else:
        mu, ratio = answer.transmission_angle, answer.radius_ratio
        tolds = [
            Told("transmission-angle", math.degrees(mu.value), mu.place, least=True),
            Told("radius-ratio-inner", ratio.value, ratio.place, least=False),
        ]
        limits = values["limits"]
        if tolds[0].value < limits["transmission_angle"] * (1.0 - CLOSE):
            yield f"sized to {tolds[0].value!r} deg, asked {limits['transmission_angle']!r}"
        if tolds[1].value > limits["radius_ratio"] * (1.0 + CLOSE):
            yield f"sized to r_R/r_K {tolds[1].value!r}, asked {limits['radius_ratio']!r}"
    for each in misses({**values, "follower": made}, design, tolds):
        yield f"size: {each}"


def misses_of(
    values: Any, rows: str | None, folder: Path, *, sizes: bool, step: float = STEP
) -> list[str]:
    """What is wrong with a scene, with a table of `rows` or none; CamgeoError if it is no cam."""
    if rows is not None:
        (folder / "lift.csv").write_text(rows)
    path = folder / "scene.toml"
    path.write_text(tomlkit.dumps(values))
    design = camgeo.load(path)
    found = [f"check: {each}" for each in misses(values, design, [*checked(design)], step)]
    found += [f"sweep: {each}" for each in misses(values, design, [*swept(design)], step)]
    return found + ([*sized(values, design)] if sizes else [])


def cases(seed: int, tables: int, plans: int) -> Iterator[tuple[str, Any, str | None]]:
    """The cases: what each is, the values of its scene, and its table if it has one."""
    for number in range(tables + plans):
        source = random.Random(f"{seed} {number}")
        kind = KINDS[number % len(KINDS)]
        if number < tables:
            values, rows = table(source, kind)
            yield f"table {number} {kind}", values, rows
        else:
            yield f"plan {number} {kind}", plan(source, kind), None


def judged(asked: Namespace) -> Iterator[Case]:
    """Two fifths of the cases are tables; those without a cam are told as such."""
    tables = 2 * asked.count // 5
    for number, case in enumerate(cases(asked.seed, tables, asked.count - tables)):
        name, values, rows = case
        with tempfile.TemporaryDirectory() as folder:
            try:
                yield name, misses_of(values, rows, Path(folder), sizes=number % SIZED == 0)
            except CamgeoError as error:
                yield f"{name}: no cam: {error}", []


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 500), judged))
