"""Random jobs of milling: what a sweep of the written program finds, against what camgeo tells.

    python -m tests.draws.jobs [--count N] [--seed HEX] [--rows FILE]

A cam, its bore, blank, holding and operations are drawn; the program that camgeo writes is taken as
it is, or with one operation shifted, lowered, raised or left out. A reader of its G-code and areas
swept slab by slab, both of this module alone, say which pieces come loose, how deep the cutter goes
into the part, and what is left on it; `camgeo check` and `camgeo lint` must say the same.
"""

from __future__ import annotations

import math
import random
import re
import sys
import tempfile
from argparse import Namespace
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import numpy as np
import shapely

import camgeo
from camgeo.app.answers.check import check
from camgeo.app.answers.lint import lint
from camgeo.design.milled import MilledDisc
from camgeo.errors import CamgeoError
from tests.draws.run import Case, parser_of, run_cases

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


def disc(diameter: float, x: float = 0.0, y: float = 0.0) -> Area:
    """A circle's area; nothing of no diameter."""
    return shapely.buffer(shapely.Point(x, y), 0.5 * diameter, quad_segs=256)


# The job -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Clamp:
    """A screw (a circle) or a clamp (a square) of `size`, set between two operations."""

    place: tuple[float, float]
    size: float
    round: bool
    since: str = ""
    until: str = ""

    @property
    def area(self) -> Area:
        half, (x, y) = 0.5 * self.size, self.place
        if self.round:
            return disc(self.size, x, y)
        return shapely.box(x - half, y - half, x + half, y + half)

    @property
    def toml(self) -> str:
        size = (
            f"head_diameter = {self.size}"
            if self.round
            else f"length = {self.size}\nwidth = {self.size}"
        )
        when = "".join(
            f'{key} = "{name}"\n'
            for key, name in (("since", self.since), ("until", self.until))
            if name
        )
        what = "screw" if self.round else "clamp"
        return f"[[holding.{what}]]\nplace = {list(self.place)}\n{size}\nheight = 4\n{when}"


@dataclass(frozen=True)
class Job:
    """What is drawn; lengths in mm."""

    rotation: int
    base: float
    roller: float
    offset: float
    stroke: float
    spans: tuple[int, int, int, int]
    thickness: float
    bore: float
    blank_bore: float
    diameter: float
    size: tuple[float, float]
    centre: tuple[float, float]
    top: float
    bottom: float
    kind: str
    through: float
    tabs: tuple[int, float, float]
    skin: float
    clamps: tuple[Clamp, ...]
    tools: tuple[float, float]
    operations: tuple[str, ...]
    change: str
    amount: tuple[float, float]
    victim: float

    @property
    def outline(self) -> Area:
        """The flank: the roller's centre path, seen from the cam, less the roller; moves are
        cycloids, of which a return is a rise in the mirror.
        """
        rise, high, fall, _ = self.spans
        degrees = np.arange(3600) / 10.0
        ends = np.cumsum((0, rise, high, fall))
        share = np.interp(degrees, ends, (0.0, 1.0, 1.0, 0.0))
        lift = self.stroke * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi))
        places = self.offset + 1j * (math.sqrt(self.base**2 - self.offset**2) + lift)
        places *= np.exp(-1j * self.rotation * np.radians(degrees))
        ring = shapely.Polygon(np.column_stack((places.real, places.imag)))
        return shapely.buffer(ring, -self.roller, quad_segs=64)

    @property
    def part(self) -> Area:
        return self.outline - disc(self.bore)

    @property
    def blank(self) -> Area:
        x, y = self.centre
        wide, high = self.size
        box = shapely.box(x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)
        return (disc(self.diameter, x, y) if self.diameter else box) - disc(self.blank_bore)

    @property
    def joined(self) -> float:
        """Z up to which waste may hang on the part."""
        low = -self.thickness
        heights = [-math.inf]
        heights += [low] if self.bottom else []
        heights += [low + self.tabs[2]] if self.kind == "tabs" else []
        heights += [low + self.skin] if self.kind == "onion-skin" else []
        return max(heights)

    @property
    def toml(self) -> str:
        """The scene."""
        kind = self.kind
        rise, high, fall, low = self.spans
        moves = (
            f'[[motion]]\nlaw = "cycloidal"\nspan = {rise}\nto = {self.stroke}\n'
            f"[[motion]]\ndwell = {high}\n"
            f'[[motion]]\nlaw = "cycloidal"\nspan = {fall}\nto = 0\n[[motion]]\ndwell = {low}\n'
        )
        bore = f"bore = {self.bore}\n" if self.bore else ""
        outline = (
            f'shape = "round"\ndiameter = {self.diameter}\n'
            if self.diameter
            else f"length = {self.size[0]}\nwidth = {self.size[1]}\n"
        )
        there = f"bore = {self.blank_bore}\n" if self.blank_bore else ""
        own = {
            "tabs": f"count = {self.tabs[0]}\nwidth = {self.tabs[1]}\nheight = {self.tabs[2]}\n",
            "onion-skin": f"thickness = {self.skin}\n",
        }.get(kind, "")
        through = "" if kind == "onion-skin" else f"through = {self.through}\n"
        tools = "".join(
            f"[[tool]]\nnumber = {number}\ndiameter = {diameter}\nspindle_speed = 3000\n"
            f"feed = 500\nplunge_feed = 150\nstepdown = 3\nstepover = {0.4 * diameter:.2f}\n"
            "ramp_angle = 6\n"
            for number, diameter in enumerate(self.tools, start=1)
        )
        return (
            'camgeo = 1\nname = "job"\n'
            f'[cam]\nrotation = "{"ccw" if self.rotation > 0 else "cw"}"\n'
            f'[follower]\nkind = "translating-roller"\nbase_radius = {self.base}\n'
            f"roller_radius = {self.roller}\noffset = {self.offset}\n"
            f"{moves}[part]\nthickness = {self.thickness}\n{bore}"
            f"[stock]\n{outline}{there}centre = {list(self.centre)}\ntop = {self.top}\n"
            f"bottom = {self.bottom}\n"
            f'[holding]\nkind = "{kind}"\n{through}{own}'
            f"{''.join(each.toml for each in self.clamps)}{tools}{''.join(self.operations)}"
            '[output]\nformats = ["gcode"]\ntolerance = 0.005\nfit = "fast"\n'
            '[output.gcode]\nmachine = "linuxcnc"\nclearance_height = 12\nretract_height = 6\n'
        )


def _operation(kind: str, tool: int, boundary: str = "", **own: object) -> str:
    lines = [f'kind = "{kind}"', f"tool = {tool}"]
    lines += [f'boundary = "{boundary}"'] if boundary else []
    lines += [
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in own.items()
    ]
    return "\n".join(("[[operation]]", *lines, ""))


CHANGES: Final = ("", "", "lower", "higher", "aside", "aside", "left out")


def drawn(source: random.Random) -> Job:
    """A job, perhaps one that cannot be planned."""
    base, roller = float(source.randint(26, 34)), float(source.randint(5, 9))
    stroke = float(source.randint(3, 8))
    rise, fall = source.randint(100, 150), source.randint(100, 150)
    high = source.randint(5, 50)
    thickness = source.choice((5.0, 6.0, 8.0))
    reach = base + stroke - roller
    small = source.choice((6.0, 8.0))
    tools = (source.choice((8.0, 10.0)), small)
    bore = source.choice((0.0, 0.0, 16.0, 18.0))
    blank_bore = bore if bore and source.random() < 0.5 else 0.0
    margin = source.choice((2.0, 6.0, 14.0, 24.0, 40.0))
    is_round = source.random() < 0.5
    wide = round(2.0 * (reach + margin), 1)
    size = (wide, round(wide + source.choice((-6.0, 0.0, 20.0)), 1))
    shift = min(margin - 1.0, 6.0)
    centre = (round(source.uniform(-shift, shift), 1), round(source.uniform(-shift, shift), 1))
    kind = source.choice(("screws", "screws", "clamps", "tabs", "onion-skin", "fixture"))
    stated = source.random() < 0.7
    top = 0.0 if stated else source.choice((0.0, 0.0, 0.5))
    clamps: list[Clamp] = []
    if kind in ("screws", "clamps") or source.random() < 0.2:
        clamps = list(_clamps(source, kind, bore, blank_bore, reach, margin, wide))
    operations: list[str] = []
    if stated:
        if bore > blank_bore:
            operations += [
                _operation("bore", 2, allowance=0.2),
                _operation("finish", 2, "bore"),
            ]
        strategy = source.choice(("ramp", "ramp", "", "spiral"))
        own = {"strategy": strategy} if strategy else {}
        tool = source.choice((1, 2))
        operations += [
            _operation("rough", tool, "outline", allowance=0.3, **own),
            _operation("finish", source.choice((tool, 2)), "outline"),
        ]
    return Job(
        rotation=source.choice((1, -1)),
        base=base,
        roller=roller,
        offset=float(source.randint(-3, 3)),
        stroke=stroke,
        spans=(rise, high, fall, 360 - rise - high - fall),
        thickness=thickness,
        bore=bore,
        blank_bore=blank_bore,
        diameter=wide if is_round else 0.0,
        size=size,
        centre=centre,
        top=top,
        bottom=1.5 if kind == "fixture" and source.random() < 0.3 else 0.0,
        kind=kind,
        through=source.choice((0.2, 0.5)),
        tabs=(source.choice((2, 3, 4)), source.choice((4.0, 6.0)), source.choice((1.0, 1.5))),
        skin=0.4,
        clamps=tuple(clamps),
        tools=tools,
        operations=tuple(operations),
        change=source.choice(CHANGES),
        amount=(round(source.uniform(0.2, 1.5), 3), source.uniform(0.0, 2.0 * math.pi)),
        victim=source.random(),
    )


def _clamps(
    source: random.Random, kind: str, bore: float, there: float, reach: float, margin: float,
    wide: float,
) -> Iterator[Clamp]:  # fmt: skip
    """On the part, and perhaps on what is around it."""
    milled = bore > there
    if not milled or kind in ("screws", "clamps"):
        since = "rough outline" if milled else source.choice(("", "", "rough outline"))
        size = max(14.0, there + 6.0, bore + 6.0 if milled else 0.0)
        yield Clamp((0.0, 0.0), size, kind != "clamps", since=since)
    if margin >= 14.0:
        along = 0.5 * wide - 3.5
        corners = [(along, 0.0), (-along, 0.0), (0.0, along), (0.0, -along)]
        for place in corners[: source.choice((0, 0, 1, 2, 4))]:
            until = source.choice(("", "", "", "outline"))
            yield Clamp(place, 4.0, source.random() < 0.5, until=until)


# The program -------------------------------------------------------------------------------------


@dataclass
class Move:
    """A feed move: a polyline of (x, y, z), z linear along it."""

    points: list[tuple[float, float, float]]


@dataclass
class Ran:
    """What one operation does: its tool, and its feed moves."""

    name: str
    tool: int = 0
    moves: list[Move] = field(default_factory=list)


WORD: Final = re.compile(r"([A-Z])(-?\d+\.?\d*)")


def read(text: str) -> list[Ran]:
    """The operations of a program of LinuxCNC in mm, with absolute and with relative centres."""
    found: list[Ran] = []
    at = [0.0, 0.0, 0.0]
    tool, mode = 0, "G0"
    for line in text.splitlines():
        if line.startswith("("):
            if line.startswith("(operation "):
                found.append(Ran(line[len("(operation ") : -1], tool))
            continue
        words = WORD.findall(line)
        values = {letter: float(number) for letter, number in words if letter not in "GM"}
        codes = [f"{letter}{float(number):g}" for letter, number in words if letter in "GM"]
        tool = int(values.get("T", tool))
        mode = next((code for code in codes if code in ("G0", "G1", "G2", "G3")), mode)
        if not values.keys() & set("XYZ"):
            continue
        end = [values.get(letter, at[k]) for k, letter in enumerate("XYZ")]
        if found:
            found[-1].tool = tool
            if mode == "G1":
                found[-1].moves.append(Move([(at[0], at[1], at[2]), (end[0], end[1], end[2])]))
            elif mode in ("G2", "G3"):
                centre = (at[0] + values.get("I", 0.0), at[1] + values.get("J", 0.0))
                found[-1].moves.append(Move(list(_arc(at, end, centre, mode == "G3"))))
        at = end
    return found


def _arc(
    start: Sequence[float], end: Sequence[float], centre: tuple[float, float], ccw: bool
) -> Iterator[tuple[float, float, float]]:
    first = math.atan2(start[1] - centre[1], start[0] - centre[0])
    last = math.atan2(end[1] - centre[1], end[0] - centre[0])
    sweep = (last - first) % (2.0 * math.pi) if ccw else -((first - last) % (2.0 * math.pi))
    if abs(sweep) < 1e-9:
        sweep = 2.0 * math.pi if ccw else -2.0 * math.pi
    radius = math.hypot(start[0] - centre[0], start[1] - centre[1])
    step = 2.0 * math.acos(max(0.0, 1.0 - CHORD / max(radius, CHORD)))
    count = max(2, math.ceil(abs(sweep) / step))
    for k in range(count + 1):
        share = k / count
        angle = first + share * sweep
        yield (
            centre[0] + radius * math.cos(angle),
            centre[1] + radius * math.sin(angle),
            start[2] + share * (end[2] - start[2]),
        )


def changed(text: str, job: Job) -> tuple[str, str]:
    """The program with one operation run otherwise; its name."""
    blocks = re.split(r"(?=^\(operation )", text, flags=re.MULTILINE)
    if not job.change or len(blocks) < 2:
        return text, ""
    number = 1 + int(job.victim * (len(blocks) - 1))
    name = blocks[number].partition("\n")[0][len("(operation ") : -1]
    if job.change == "left out":
        moves = r"^(?:G[0123] |[XYZ]).*\n"
        kept = re.sub(moves, "", blocks[number], flags=re.MULTILINE)
        blocks[number] = kept
        return "".join(blocks), name
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
    return "".join(blocks), name


# The sweep ---------------------------------------------------------------------------------------


def swept(moves: Sequence[Move], z: float, radius: float) -> Area:
    """What the cutter passes over with its tip below `z`."""
    chains: list[list[tuple[float, float]]] = []
    for move in moves:
        chain: list[tuple[float, float]] = []
        for (x0, y0, z0), (x1, y1, z1) in pairwise(move.points):
            if z0 >= z and z1 >= z:
                if chain:
                    chains.append(chain)
                chain = []
                continue
            from_share, to_share = 0.0, 1.0
            if z0 > z:
                from_share = (z0 - z) / (z0 - z1)
            elif z1 > z:
                to_share = (z - z0) / (z1 - z0)
            if not chain:
                chain = [(x0 + from_share * (x1 - x0), y0 + from_share * (y1 - y0))]
            chain.append((x0 + to_share * (x1 - x0), y0 + to_share * (y1 - y0)))
        if chain:
            chains.append(chain)
    lines = [
        shapely.LineString(chain) if len(set(chain)) > 1 else shapely.Point(chain[0])
        for chain in chains
    ]
    return (
        shapely.union_all(shapely.buffer(lines, radius, quad_segs=48)) if lines else shapely.Point()
    )


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
    low = -job.thickness
    heights = {low, 0.0, job.top, low - job.bottom}
    if math.isfinite(job.joined):
        heights.add(job.joined)
        # The flanks of tabs slope, and hold at their feet what is farther off than their tops.
        steps = math.ceil((job.joined - low) / FOOT)
        heights |= {low + FOOT * k for k in range(1, steps)}
    for run in runs:
        for move in run.moves:
            (_, _, z0), (_, _, z1) = move.points[0], move.points[-1]
            if z0 == z1 or move.points[0][:2] == move.points[-1][:2]:
                heights |= {z1}
    ordered = sorted(z for z in heights if low - job.bottom <= z <= job.top)
    edges = [ordered[0]]
    for z in ordered[1:]:
        if z - edges[-1] > 1e-4:
            edges.append(z)
    slabs = list(pairwise(edges))
    middles = [0.5 * (z0 + z1) for z0, z1 in slabs]
    part = [job.part if low < z < 0.0 else shapely.Polygon() for z in middles]
    material = [job.blank for _ in slabs]
    found = Told()
    gone: list[list[tuple[int, Area]]] = []
    for run in runs:
        radius = 0.5 * job.tools[run.tool - 1]
        areas = [swept(run.moves, z, radius) for z in middles]
        deepest = max(
            (
                _depth(area, body, -z0)
                for (z0, _), area, body in zip(slabs, areas, part, strict=True)
                if not body.is_empty
            ),
            default=0.0,
        )
        if deepest:
            found.gouges[run.name] = deepest
        material = [left - area for left, area in zip(material, areas, strict=True)]
        for piece in _loose(job, run.name, names, material, part):
            if any(_same(piece, each) for each in gone):
                continue
            gone.append(piece)
            volume = sum((slabs[k][1] - slabs[k][0]) * area.area for k, area in piece)
            found.loose.setdefault(run.name, []).append(volume)
    found.rest = max(
        (
            _rest(left, body)
            for (_, z1), left, body in zip(slabs, material, part, strict=True)
            if not body.is_empty and z1 > job.joined + 1e-6
        ),
        default=0.0,
    )
    above = [left for z, left in zip(middles, material, strict=True) if z > 0.0]
    if any(shapely.intersection(left, job.part).area > 1.0 for left in above):
        found.rest = max(found.rest, job.top)
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
    group = list(range(len(nodes)))
    for i, (k, one) in enumerate(nodes):
        for j, (m, other) in enumerate(nodes):
            joined = m == k + 1 and shapely.intersection(one, other).area > 1e-4
            if joined and group[i] != group[j]:
                old, new = group[j], group[i]
                group = [new if each == old else each for each in group]
    return [
        [node for node, own in zip(nodes, group, strict=True) if own == number]
        for number in sorted(set(group))
    ]


def _loose(
    job: Job, name: str, names: Sequence[str], material: Sequence[Area], part: Sequence[Area]
) -> Iterator[list[tuple[int, Area]]]:
    """Pieces that nothing holds after an operation."""
    index = names.index(name)
    there, clamped = [], job.kind not in ("screws", "clamps")
    for clamp in job.clamps:
        since = names.index(clamp.since) if clamp.since else 0
        clamped |= since <= index
        until = names.index(clamp.until) if clamp.until else len(names)
        if since <= index < until:
            there.append(clamp.area)
    if job.kind == "fixture":
        there.append(job.part)
    found = _pieces(material)
    if not clamped and sum(not _is_thin(piece) for piece in found) == 1:
        return  # how the blank is held before is not stated
    held = [piece for piece in found if _touches(piece, there)]
    if not there and job.kind in ("tabs", "onion-skin"):
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

VOLUME: Final = re.compile(r"([\d.]+(?:e[+-]\d+)?) mm\^3")
DEEP: Final = re.compile(r"goes ([\d.e+-]+) mm into the part")
THICK: Final = re.compile(r"up to ([\d.e+-]+) mm thick")


def said(sentences: Sequence[tuple[str, str, str]]) -> Told:
    """Of rows of kind, operation and sentence."""
    found = Told()
    for kind, name, sentence in sentences:
        if kind == "loose":
            found.loose.setdefault(name, []).append(float(_number(VOLUME, sentence)))
        elif kind == "gouge":
            deep = float(_number(DEEP, sentence))
            found.gouges[name] = max(found.gouges.get(name, 0.0), deep)
        else:
            found.rest = max(found.rest, float(_number(THICK, sentence)))
    return found


def _number(pattern: re.Pattern[str], sentence: str) -> str:
    match = pattern.search(sentence)
    assert match is not None, sentence
    return match[1]


RULES: Final = {"loose-piece": "loose", "gouged-part": "gouge", "rest": "rest"}
FINDINGS: Final = {"loose": "loose", "loose-core": "loose", "gouge": "gouge", "rest": "rest"}


def linted(path: Path, scene: str) -> Told:
    """By `camgeo lint` of a program with the scene of a job."""
    (program,) = lint([path], "linuxcnc", design=camgeo.loads(scene)).programs
    assert program.found is not None, program.damage
    rows = []
    for each in program.findings:
        if each.found.rule in RULES:
            name, _, sentence = each.found.what.partition(": ")
            rows.append((RULES[each.found.rule], name, sentence))
    return said(rows)


def checked(scene: str) -> Told:
    """By `camgeo check`, what is to be watched too."""
    found = check(camgeo.loads(scene)).machining
    assert found is not None
    rows = []
    for each in found.findings:
        if each.name in FINDINGS and each.severity in ("warning", "broken"):
            name, _, sentence = each.sentence.partition(": ")
            rows.append((FINDINGS[each.name], name, sentence))
    return said(rows)


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
    with tempfile.TemporaryDirectory() as folder:
        try:
            with patch.object(MilledDisc, "safe", lambda *_: ()):  # also one that must not be run
                camgeo.loads(job.toml).write(folder, ["gcode"])
        except CamgeoError:
            return None
        path = Path(folder) / "job.ngc"
        plain = path.read_text()
        names = [run.name for run in read(plain)]
        text, _ = changed(plain, job)
        path.write_text(text)
        told = linted(path, job.toml)
    ours = simulated(job, [run for run in read(text) if run.moves], names)
    # What a fixture must hold is to be watched, and no fault of the program.
    unwatched = replace(ours, loose={}) if job.kind == "fixture" else ours
    found = list(differences(unwatched, told, "lint"))
    if not job.change:
        found += differences(ours, checked(job.toml), "check")
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
        sizes = f"{sum(map(len, ours.loose.values()))} loose, {len(ours.gouges)} gouges"
        what = f"{done} {job.kind}, {job.change or 'as written'}: {sizes}, rest {ours.rest:.3f} mm"
        yield f"{what} {job}" if found else what, found


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 60), compared))
