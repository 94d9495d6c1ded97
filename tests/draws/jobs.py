"""Random jobs of milling: what a sweep of the written program finds, against what camgeo tells.

    python -m tests.draws.jobs [--count N] [--seed HEX] [--rows FILE]

A cam, its bore, blank, holding and operations are drawn; the program that camgeo writes is taken as
it is, or with one operation shifted, lowered, raised or left out. Areas swept slab by slab, by this
module alone, and the reader of `tests.end_to_end.program` say which pieces come loose, how deep the
cutter goes into the part, and what is left on it; `camgeo check` and `camgeo lint` must say so too.
"""

from __future__ import annotations

import math
import random
import re
import sys
import tempfile
from argparse import Namespace
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import numpy as np
import shapely
import tomlkit
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import camgeo
from camgeo.app.answers.check import check
from camgeo.app.answers.lint import lint
from camgeo.design.milled import MilledDisc
from camgeo.errors import CamgeoError
from camgeo.numeric.arrays import FloatArray
from tests.draws.run import Case, parser_of, run_cases
from tests.draws.walls import flank
from tests.end_to_end.program import Move, run

ALLOWED: Final = 0.02
"""[mm] by which cutter and part may overlap, or miss each other, without a word."""

UNSURE: Final = 0.06
"""Depths and thicknesses [mm] below which chords, rounding and what is allowed decide."""

CHORD: Final = 0.002
"""Deviation of chords from arcs [mm]."""

FOOT: Final = 0.1
"""Height [mm] of the slabs where waste may hang on the part."""

SMALL: Final = 1.0
"""Volume [mm^3] of pieces that are not compared: splinters at the ends of paths."""

Area = Any

Table = dict[str, Any]


def disc(diameter: float, x: float = 0.0, y: float = 0.0) -> Area:
    """A circle's area; nothing of no diameter."""
    return shapely.buffer(shapely.Point(x, y), 0.5 * diameter, quad_segs=256)


# The job -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Job:
    """A scene, and what one operation of its program does otherwise: by how much [mm] and in which
    direction [rad], and which it is, as a share of their number.
    """

    scene: Table
    change: str
    amount: tuple[float, float]
    victim: float

    @property
    def thickness(self) -> float:
        """Of the part [mm]."""
        return float(self.scene["part"]["thickness"])

    @property
    def part(self) -> Area:
        outline = shapely.Polygon(flank(self.scene, -1, step=0.1))
        return outline - disc(self.scene["part"].get("bore", 0.0))

    @property
    def blank(self) -> Area:
        return covered(self.scene["stock"]) - disc(self.scene["stock"].get("bore", 0.0))

    @property
    def joined(self) -> float:
        """Z up to which waste may hang on the part."""
        holding = self.scene["holding"]
        high = holding.get("height", holding.get("thickness", 0.0))  # of tabs, or of a skin
        return high - self.thickness if high or self.scene["stock"]["bottom"] else -math.inf


def covered(table: Table) -> Area:
    """What a blank, a screw (a circle) or a clamp (a square) covers."""
    x, y = table["centre" if "centre" in table else "place"]
    diameter = table.get("diameter", table.get("head_diameter"))
    if diameter is not None:
        return disc(diameter, x, y)
    half, high = 0.5 * table["length"], 0.5 * table["width"]
    return shapely.box(x - half, y - high, x + half, y + high)


CHANGES: Final = ("", "", "lower", "higher", "aside", "aside", "left out")


def drawn(source: random.Random) -> Job:
    """A job, perhaps one that cannot be planned."""
    follower: Table = {
        "kind": "translating-roller",
        "base_radius": float(source.randint(26, 34)),
        "roller_radius": float(source.randint(5, 9)),
    }
    stroke = float(source.randint(3, 8))
    rise, fall = source.randint(100, 150), source.randint(100, 150)
    high = source.randint(5, 50)
    part: Table = {"thickness": source.choice((5.0, 6.0, 8.0))}
    reach = follower["base_radius"] + stroke - follower["roller_radius"]
    small = source.choice((6.0, 8.0))
    diameters = (source.choice((8.0, 10.0)), small)
    bore = source.choice((0.0, 0.0, 16.0, 18.0))
    there = bore if bore and source.random() < 0.5 else 0.0
    part |= {"bore": bore} if bore else {}
    margin = source.choice((2.0, 6.0, 14.0, 24.0, 40.0))
    is_round = source.random() < 0.5
    wide = round(2.0 * (reach + margin), 1)
    deep = round(wide + source.choice((-6.0, 0.0, 20.0)), 1)
    shift = min(margin - 1.0, 6.0)
    stock: Table = {
        "centre": [round(source.uniform(-shift, shift), 1) for _ in range(2)],
        **({"shape": "round", "diameter": wide} if is_round else {"length": wide, "width": deep}),
        **({"bore": there} if there else {}),
    }
    kind = source.choice(("screws", "screws", "clamps", "tabs", "onion-skin", "fixture"))
    stated = source.random() < 0.7
    stock["top"] = 0.0 if stated else source.choice((0.0, 0.0, 0.5))
    holding: Table = {"kind": kind}
    if kind in ("screws", "clamps") or source.random() < 0.2:
        for what, table in _clamps(source, kind, bore, there, margin, wide):
            holding.setdefault(what, []).append({**table, "height": 4})
    operations: list[Table] = []
    if stated:
        if bore > there:
            operations += [
                {"kind": "bore", "tool": 2, "allowance": 0.2},
                {"kind": "finish", "tool": 2, "boundary": "bore"},
            ]
        strategy = source.choice(("ramp", "ramp", "", "spiral"))
        rough: Table = {"kind": "rough", "tool": source.choice((1, 2)), "boundary": "outline"}
        rough |= {"allowance": 0.3, **({"strategy": strategy} if strategy else {})}
        last = source.choice((rough["tool"], 2))
        operations += [rough, {"kind": "finish", "tool": last, "boundary": "outline"}]
    rotation = source.choice(("ccw", "cw"))
    follower["offset"] = float(source.randint(-3, 3))
    stock["bottom"] = 1.5 if kind == "fixture" and source.random() < 0.3 else 0.0
    through = source.choice((0.2, 0.5))
    tabs = {"count": (2, 3, 4), "width": (4.0, 6.0), "height": (1.0, 1.5)}
    own = {key: source.choice(values) for key, values in tabs.items()}
    holding |= {"thickness": 0.4} if kind == "onion-skin" else {"through": through}
    holding |= own if kind == "tabs" else {}
    tools = [
        {
            "number": number,
            "diameter": diameter,
            "spindle_speed": 3000,
            "feed": 500,
            "plunge_feed": 150,
            "stepdown": 3,
            "stepover": round(0.4 * diameter, 2),
            "ramp_angle": 6,
        }
        for number, diameter in enumerate(diameters, start=1)
    ]
    motion = [
        {"law": "inclined-sine", "span": rise, "to": stroke},
        {"dwell": high},
        {"law": "inclined-sine", "span": fall, "to": 0.0},
        {"dwell": 360 - rise - high - fall},
    ]
    gcode = {"machine": "linuxcnc", "clearance_height": 12, "retract_height": 6}
    scene: Table = {
        "camgeo": 1,
        "name": "job",
        "cam": {"rotation": rotation},
        "follower": follower,
        "motion": motion,
        "part": part,
        "stock": stock,
        "holding": holding,
        "tool": tools,
        **({"operation": operations} if operations else {}),
        "output": {"formats": ["gcode"], "tolerance": 0.005, "fit": "fast", "gcode": gcode},
    }
    return Job(
        scene,
        change=source.choice(CHANGES),
        amount=(round(source.uniform(0.2, 1.5), 3), source.uniform(0.0, 2.0 * math.pi)),
        victim=source.random(),
    )


def _clamps(
    source: random.Random, kind: str, bore: float, there: float, margin: float, wide: float
) -> Iterator[tuple[str, Table]]:
    """Screws and clamps on the part, and perhaps on what is around it."""
    milled = bore > there
    if not milled or kind in ("screws", "clamps"):
        since = "rough outline" if milled else source.choice(("", "", "rough outline"))
        size = max(14.0, there + 6.0, bore + 6.0 if milled else 0.0)
        yield _clamp(kind != "clamps", size, (0.0, 0.0), "since", since)
    if margin >= 14.0:
        along = 0.5 * wide - 3.5
        corners = [(along, 0.0), (-along, 0.0), (0.0, along), (0.0, -along)]
        for place in corners[: source.choice((0, 0, 1, 2, 4))]:
            until = source.choice(("", "", "", "outline"))
            yield _clamp(source.random() < 0.5, 4.0, place, "until", until)


def _clamp(
    is_screw: bool, size: float, place: tuple[float, float], key: str, operation: str
) -> tuple[str, Table]:
    """Set or removed before an operation, if one is named."""
    sizes = {"head_diameter": size} if is_screw else {"length": size, "width": size}
    when = {key: operation} if operation else {}
    return "screw" if is_screw else "clamp", {"place": list(place), **sizes, **when}


# The program -------------------------------------------------------------------------------------


@dataclass
class Ran:
    """What one operation does: its tool, and its feed moves, each as (n, 3) places [mm] evenly
    along a line or an arc.
    """

    name: str
    tool: int = 0
    moves: list[FloatArray] = field(default_factory=list)


def read(text: str) -> list[Ran]:
    """The operations of a program of LinuxCNC."""
    return [
        Ran(name, moves[-1].tool, [_places(move) for move in moves if move.code])
        for name, moves in run(text).operations.items()
        if name
    ]


def _places(move: Move) -> FloatArray:
    """Places on a line, or on an arc."""
    shares, places = np.array([0.0, 1.0]), np.array([move.start, move.end])
    if move.sweep:
        arm = move.start - move.centre
        step = 2.0 * math.acos(max(0.0, 1.0 - CHORD / max(abs(arm), CHORD)))
        shares = np.linspace(0.0, 1.0, max(2, math.ceil(abs(move.sweep) / step)) + 1)
        places = move.centre + arm * np.exp(1j * move.sweep * shares)
    heights = move.z_start + shares * (move.z_end - move.z_start)
    return np.column_stack((places.real, places.imag, heights))


def changed(text: str, job: Job) -> str:
    """The program with one operation run otherwise."""
    blocks = re.split(r"(?=^\(operation )", text, flags=re.MULTILINE)
    if not job.change or len(blocks) < 2:
        return text
    number = 1 + int(job.victim * (len(blocks) - 1))
    if job.change == "left out":
        moves = r"^(?:G[0123] |[XYZ]).*\n"
        blocks[number] = re.sub(moves, "", blocks[number], flags=re.MULTILINE)
        return "".join(blocks)
    far, angle = job.amount
    by = {
        "lower": {"Z": -far},
        "higher": {"Z": far},
        "aside": {"X": far * math.cos(angle), "Y": far * math.sin(angle)},
    }[job.change]

    def word(found: re.Match[str]) -> str:
        return f"{found[1]}{float(found[2]) + by.get(found[1], 0.0):.4f}"

    lines = []
    for line in blocks[number].splitlines(keepends=True):
        rapid = line.startswith("G0") and "Z" in by
        lines.append(
            line if line.startswith("(") or rapid else re.sub(r"([XYZ])(-?\d+\.?\d*)", word, line)
        )
    blocks[number] = "".join(lines)
    return "".join(blocks)


# The sweep ---------------------------------------------------------------------------------------


def swept(moves: Sequence[FloatArray], z: float, radius: float) -> Area:
    """What the cutter passes over with its tip below `z`."""
    ways = [_below(move, z) for move in moves if np.min(move[:, 2]) < z]
    lines = [
        shapely.LineString(way) if np.any(way != way[0]) else shapely.Point(way[0]) for way in ways
    ]
    return shapely.union_all(shapely.buffer(lines, radius, quad_segs=48))


def _below(move: FloatArray, z: float) -> FloatArray:
    """(m, 2) places of the part of a move where the tip is below `z`."""
    high, low = move[0, 2], move[-1, 2]
    share = (z - high) / (low - high) if max(high, low) > z else 0.0
    first, last = (share if high > z else 0.0), (share if low > z else 1.0)
    shares = np.linspace(0.0, 1.0, len(move))
    inner = shares[(shares > first) & (shares < last)]
    at = np.concatenate(([first], inner, [last]))
    return np.column_stack([np.interp(at, shares, move[:, axis]) for axis in (0, 1)])


def polygons(area: Area) -> list[Area]:
    return [each for each in shapely.get_parts(area) if each.geom_type == "Polygon"]


def farthest(area: Area, other: Area) -> float:
    """How far a point of `area` is from `other` at most, by halving."""
    low, high = 0.0, 200.0
    while high - low > 0.004:
        middle = 0.5 * (low + high)
        if shapely.difference(area, shapely.buffer(other, middle, quad_segs=32)).area > 1e-6:
            low = middle
        else:
            high = middle
    return low


@dataclass
class Told:
    """What is found of a program: loose pieces [mm^3] and the depth of the worst gouge [mm] by
    operations, and the thickness of the thickest rest [mm].
    """

    loose: dict[str, list[float]] = field(default_factory=dict)
    gouges: dict[str, float] = field(default_factory=dict)
    rest: float = 0.0


def simulated(job: Job, runs: Sequence[Ran], names: Sequence[str]) -> Told:
    """Slab by slab; `names` are those of the operations that are planned."""
    low, whole, stock = -job.thickness, job.part, job.scene["stock"]
    least, top = low - stock["bottom"], stock["top"]
    heights = {low, 0.0, top, least}
    if math.isfinite(job.joined):
        # The flanks of tabs slope, and hold at their feet what is farther off than their tops.
        heights |= {job.joined, *np.arange(low + FOOT, job.joined - 1e-9, FOOT)}
    for each in runs:
        for move in each.moves:
            if move[0, 2] == move[-1, 2] or np.all(move[0, :2] == move[-1, :2]):
                heights.add(move[-1, 2])
    ordered = sorted(z for z in heights if least <= z <= top)
    edges = [ordered[0]]
    for z in ordered[1:]:
        if z - edges[-1] > 1e-4:
            edges.append(z)
    slabs = list(pairwise(edges))
    middles = [0.5 * (z0 + z1) for z0, z1 in slabs]
    part = [whole if low < z < 0.0 else shapely.Polygon() for z in middles]
    material = [job.blank] * len(slabs)
    found = Told()
    gone: list[list[tuple[int, Area]]] = []
    for each in runs:
        radius = 0.5 * job.scene["tool"][each.tool - 1]["diameter"]
        areas = [swept(each.moves, z, radius) for z in middles]
        deepest = max(
            (
                _depth(area, body, -z0)
                for (z0, _), area, body in zip(slabs, areas, part, strict=True)
                if not body.is_empty
            ),
            default=0.0,
        )
        if deepest:
            found.gouges[each.name] = deepest
        material = [left - area for left, area in zip(material, areas, strict=True)]
        for piece in _loose(job, each.name, names, material, part):
            if any(_same(piece, other) for other in gone):
                continue
            gone.append(piece)
            volume = sum((slabs[k][1] - slabs[k][0]) * area.area for k, area in piece)
            found.loose.setdefault(each.name, []).append(volume)
    found.rest = max(
        (
            _rest(left, body)
            for (_, z1), left, body in zip(slabs, material, part, strict=True)
            if not body.is_empty and z1 > job.joined + 1e-6
        ),
        default=0.0,
    )
    above = [left for z, left in zip(middles, material, strict=True) if z > 0.0]
    if any(shapely.intersection(left, whole).area > 1.0 for left in above):
        found.rest = max(found.rest, top)
    return found


def _depth(area: Area, part: Area, below: float) -> float:
    """Of a cutter in the part whose upper face is `below` higher [mm]."""
    if shapely.intersection(area, shapely.buffer(part, -1.5 * ALLOWED)).area < 1e-3:
        return 0.0
    touched = shapely.intersection(area, part)
    return min(farthest(touched, shapely.boundary(part)), below)


def _rest(left: Area, part: Area) -> float:
    """Thickness of what is left beside the part."""
    beside = left - shapely.buffer(part, ALLOWED)
    thick = shapely.buffer(shapely.buffer(beside, -0.5 * ALLOWED), 0.5 * ALLOWED)
    close = shapely.buffer(part, 2.0 * ALLOWED)
    near = [each for each in polygons(thick) if shapely.intersects(each, close)]
    return max((farthest(each, part) for each in near), default=0.0)


def _pieces(material: Sequence[Area]) -> list[list[tuple[int, Area]]]:
    """Connected parts of slabs."""
    nodes = [(k, each) for k, area in enumerate(material) for each in polygons(area)]
    above = [
        [m == k + 1 and shapely.intersection(one, other).area > 1e-4 for m, other in nodes]
        for k, one in nodes
    ]
    count, labels = connected_components(coo_array(np.array(above)), directed=False)
    return [
        [node for node, label in zip(nodes, labels, strict=True) if label == number]
        for number in range(count)
    ]


ENDS: Final = {"since": 0, "until": 1000}
"""Numbers of operations from which on, and up to which, a clamp is there that names none."""


def _loose(
    job: Job, name: str, names: Sequence[str], material: Sequence[Area], part: Sequence[Area]
) -> Iterator[list[tuple[int, Area]]]:
    """Pieces that nothing holds after an operation."""
    index, holding = names.index(name), job.scene["holding"]
    clamps = [*holding.get("screw", ()), *holding.get("clamp", ())]
    times = [
        tuple(names.index(each[key]) if key in each else end for key, end in ENDS.items())
        for each in clamps
    ]
    kind = holding["kind"]
    clamped = kind not in ("screws", "clamps") or any(since <= index for since, _ in times)
    there = [
        covered(each)
        for each, (since, until) in zip(clamps, times, strict=True)
        if since <= index < until
    ]
    there += [job.part] if kind == "fixture" else []
    found = _pieces(material)
    if not clamped and sum(not _is_thin(piece) for piece in found) == 1:
        return  # how the blank is held before is not stated
    held = [piece for piece in found if _touches(piece, there)]
    if not there and kind in ("tabs", "onion-skin"):
        edge = job.blank - shapely.buffer(shapely.Polygon(job.blank.exterior), -1.0)
        held = [piece for piece in found if _touches(piece, [edge])]
        hanging = [
            piece
            for piece in held
            if any(shapely.intersection(area, part[k]).area > 1e-4 for k, area in piece)
        ]
        held = hanging or held
    for piece in found:
        if piece not in held and not _is_thin(piece):
            yield piece


def _is_thin(piece: Sequence[tuple[int, Area]]) -> bool:
    return all(shapely.buffer(area, -0.5 * ALLOWED).is_empty for _, area in piece)


def _touches(piece: Sequence[tuple[int, Area]], there: Sequence[Area]) -> bool:
    return any(shapely.intersection(area, each).area > 1e-4 for _, area in piece for each in there)


def _same(piece: Sequence[tuple[int, Area]], other: Sequence[tuple[int, Area]]) -> bool:
    before = dict(other)
    k, area = piece[0]
    return k in before and shapely.intersection(area, before[k]).area > 1e-4


# What camgeo tells -------------------------------------------------------------------------------

NUMBERS: Final = {
    "loose": re.compile(r"([\d.]+(?:e[+-]\d+)?) mm\^3"),
    "gouge": re.compile(r"goes ([\d.e+-]+) mm into the part"),
    "rest": re.compile(r"up to ([\d.e+-]+) mm thick"),
}


def said(findings: Iterable[tuple[str, str]]) -> Told:
    """Of kinds, and sentences that begin with the operation."""
    found = Told()
    for kind, sentence in findings:
        name = sentence.partition(": ")[0]
        match = NUMBERS[kind].search(sentence)
        assert match is not None, sentence
        value = float(match[1])
        if kind == "loose":
            found.loose.setdefault(name, []).append(value)
        elif kind == "gouge":
            found.gouges[name] = max(found.gouges.get(name, 0.0), value)
        else:
            found.rest = max(found.rest, value)
    return found


RULES: Final = {"loose-piece": "loose", "gouged-part": "gouge", "rest": "rest"}
FINDINGS: Final = {"loose": "loose", "loose-core": "loose", "gouge": "gouge", "rest": "rest"}


def linted(path: Path, scene: str) -> Told:
    """By `camgeo lint` of a program with the scene of a job."""
    (program,) = lint([path], "linuxcnc", design=camgeo.loads(scene)).programs
    assert program.linted is not None, program.damage
    found = (each.finding for each in program.findings)
    return said((RULES[each.rule], each.what) for each in found if each.rule in RULES)


def checked(scene: str) -> Told:
    """By `camgeo check`, what is to be watched too."""
    found = check(camgeo.loads(scene)).machining
    assert found is not None
    return said(
        (FINDINGS[each.name], each.sentence)
        for each in found.findings
        if each.name in FINDINGS and each.severity in ("warning", "broken")
    )


# Comparing ---------------------------------------------------------------------------------------


def differences(ours: Told, theirs: Told, door: str) -> Iterator[str]:
    """Where an independent sweep and camgeo differ."""
    for name in sorted(ours.loose.keys() | theirs.loose.keys()):
        lost = sorted(each for each in ours.loose.get(name, ()) if each > SMALL)
        camgeos = sorted(each for each in theirs.loose.get(name, ()) if each > SMALL)
        same = len(lost) == len(camgeos) and all(
            abs(a - b) <= 2.0 + 0.02 * a for a, b in zip(lost, camgeos, strict=True)
        )
        if not same:
            yield f"{door}: {name}: loose {lost} mm^3, camgeo {camgeos}"
    for name in sorted(ours.gouges.keys() | theirs.gouges.keys()):
        deep, camgeo_deep = ours.gouges.get(name, 0.0), theirs.gouges.get(name, 0.0)
        if max(deep, camgeo_deep) > UNSURE and abs(deep - camgeo_deep) > 0.02 + 0.05 * deep:
            yield f"{door}: {name}: gouge {deep:.3f} mm, camgeo {camgeo_deep:.3f}"
    if (
        max(ours.rest, theirs.rest) > UNSURE
        and abs(ours.rest - theirs.rest) > 0.03 + 0.05 * ours.rest
    ):
        yield f"{door}: rest {ours.rest:.3f} mm, camgeo {theirs.rest:.3f}"


def misses(job: Job) -> tuple[Told, list[str]] | None:
    """What a sweep finds of a job, and where camgeo differs; None if it plans no program."""
    scene = tomlkit.dumps(job.scene)
    with tempfile.TemporaryDirectory() as folder:
        try:
            with patch.object(MilledDisc, "safe", lambda *_: ()):  # also one that must not be run
                camgeo.loads(scene).write(folder, ["gcode"])
        except CamgeoError:
            return None
        path = Path(folder) / "job.ngc"
        plain = path.read_text()
        text = changed(plain, job)
        path.write_text(text)
        told = linted(path, scene)
    names = [each.name for each in read(plain)]
    ours = simulated(job, [each for each in read(text) if each.moves], names)
    # What a fixture must hold is to be watched, and no fault of the program.
    unwatched = replace(ours, loose={}) if job.scene["holding"]["kind"] == "fixture" else ours
    found = list(differences(unwatched, told, "lint"))
    if not job.change:
        found += differences(ours, checked(scene), "check")
    return ours, found


def compared(asked: Namespace) -> Iterator[Case]:
    """As many jobs as are asked for, with what a sweep has found and where camgeo differs."""
    source, done = random.Random(asked.seed), 0
    while done < asked.count:
        job = drawn(source)
        result = misses(job)
        if result is None:
            continue
        done += 1
        ours, found = result
        kind, change = job.scene["holding"]["kind"], job.change or "as written"
        sizes = f"{sum(map(len, ours.loose.values()))} loose, {len(ours.gouges)} gouges"
        what = f"{done} {kind}, {change}: {sizes}, rest {ours.rest:.3f} mm"
        yield f"{what} {job}" if found else what, found


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 60), compared))
