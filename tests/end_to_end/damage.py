"""Deliberate damage to files of camgeo, as by a slip, an editor or a converter."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo_export.verify.stl import FACET, PREFIX
from tests.packages import repacked

TOLERANCE = 1e-3
"""At which the files are built [mm]."""

MOVED = 2.0 * TOLERANCE

Damage = Callable[[bytes], bytes]

MODEL = "3D/3dmodel.model"


def replaced(old: bytes, new: bytes, count: int = 1) -> Damage:
    """The first `count` occurrences replaced, all of them for -1."""
    return lambda data: data.replace(old, new, count)


def cut_short(data: bytes) -> bytes:
    return data[: len(data) * 7 // 10]


# Drawings -----------------------------------------------------------------------------------------


class Drawing:
    """The lines of a DXF, and where its entities of one kind stand.

    `longest` is the one with the most points on layer CUT, i.e. the outline.
    """

    def __init__(self, data: bytes, kind: str = "LWPOLYLINE") -> None:
        self.lines = data.decode().split("\n")
        words = [line.strip() for line in self.lines]
        pairs = list(zip(words[::2], words[1::2], strict=False))
        starts = [k for k, pair in enumerate(pairs) if pair == ("0", kind)]
        ends = [next(k for k in range(s + 1, len(pairs)) if pairs[k][0] == "0") for s in starts]
        self.codes = [code for code, _ in pairs]
        self.entities = [range(s, e) for s, e in zip(starts, ends, strict=True)]
        cut = [each for each in self.entities if self.lines[self.values(8, each)[0]] == "CUT"]
        self.longest = max(cut, key=lambda each: len(self.values(10, each)))

    def values(self, code: int, entity: range | None = None) -> list[int]:
        """The lines with the values of a group in an entity, by default the longest."""
        inside = self.longest if entity is None else entity
        return [2 * k + 1 for k in inside if self.codes[k] == str(code)]

    def point(self, vertex: int) -> complex:
        x, y = (float(self.lines[self.values(code)[vertex]]) for code in (10, 20))
        return complex(x, y)

    def change(self, place: int, value: float) -> None:
        self.lines[place] = repr(value)

    def data(self, left_out: range = range(0)) -> bytes:
        """The file, without some of its groups."""
        kept = self.lines[: 2 * left_out.start] + self.lines[2 * left_out.stop :]
        return "\n".join(kept if left_out else self.lines).encode()


def move_dxf_vertex(data: bytes) -> bytes:
    """Across the outline."""
    drawing = Drawing(data)
    before, point, after = (drawing.point(k) for k in (4, 5, 6))
    moved = point + MOVED * 1j * (after - before) / abs(after - before)
    for code, value in ((10, moved.real), (20, moved.imag)):
        drawing.change(drawing.values(code)[5], value)
    return drawing.data()


def turn_bulge(data: bytes) -> bytes:
    drawing = Drawing(data)
    place = max(drawing.values(42), key=lambda k: abs(float(drawing.lines[k])))
    drawing.change(place, -float(drawing.lines[place]))
    return drawing.data()


def leave_out_vertex(data: bytes) -> bytes:
    drawing = Drawing(data)
    x, following = drawing.values(10)[6:8]
    (count,) = drawing.values(90)
    drawing.lines[count] = str(int(drawing.lines[count]) - 1)
    return drawing.data(range(x // 2, following // 2))


def leave_out_polyline(data: bytes) -> bytes:
    drawing = Drawing(data)
    return drawing.data(next(each for each in drawing.entities if each != drawing.longest))


def leave_out_spline(data: bytes) -> bytes:
    drawing = Drawing(data, "SPLINE")
    return drawing.data(drawing.longest)


def change_insunits(data: bytes) -> bytes:
    head, name, rest = data.partition(b"$INSUNITS")
    return head + name + re.sub(rb"^(\s*70\s+)\d", rb"\g<1>1", rest, count=1)


def times(factor: float, *codes: int) -> Damage:
    """All values of some groups of polylines multiplied."""

    def multiplied(data: bytes) -> bytes:
        drawing = Drawing(data)
        for entity in drawing.entities:
            for place in (k for code in codes for k in drawing.values(code, entity)):
                drawing.change(place, factor * float(drawing.lines[place]))
        return drawing.data()

    return multiplied


def open_polyline(data: bytes) -> bytes:
    drawing = Drawing(data)
    (flags,) = drawing.values(70)
    drawing.lines[flags] = "0"
    return drawing.data()


def change_dxf_digit(data: bytes) -> bytes:
    """The second decimal of a coordinate, across the outline."""
    drawing = Drawing(data)

    def level(vertex: int) -> float:
        """How nearly the outline runs along x at a vertex."""
        along = drawing.point(vertex + 1) - drawing.point(vertex - 1)
        return abs(along.real) / abs(along)

    place = drawing.values(20)[max(range(1, len(drawing.values(10)) - 1), key=level)]
    text = drawing.lines[place]
    digit = text.index(".") + 2
    drawing.lines[place] = text[:digit] + ("1" if text[digit] != "1" else "3") + text[digit + 1 :]
    return drawing.data()


def change_dxf_last_digit(data: bytes) -> bytes:
    drawing = Drawing(data)
    place = drawing.values(20)[8]
    text = drawing.lines[place].rstrip()
    drawing.lines[place] = text[:-1] + ("1" if text[-1] != "1" else "2")
    return drawing.data()


def move_control(data: bytes) -> bytes:
    """Moved so far that the curve moves by at least two tolerances: a control point weighs 2/3."""
    drawing = Drawing(data, "SPLINE")
    controls = drawing.values(10)
    place = controls[len(controls) // 2]
    drawing.change(place, float(drawing.lines[place]) + 5.0 * MOVED)
    return drawing.data()


def change_knot(data: bytes) -> bytes:
    """Half way to the knot after it."""
    drawing = Drawing(data, "SPLINE")
    knots = drawing.values(40)
    place, after = knots[len(knots) // 2 : len(knots) // 2 + 2]
    drawing.change(place, 0.5 * (float(drawing.lines[place]) + float(drawing.lines[after])))
    return drawing.data()


# Programs -----------------------------------------------------------------------------------------


def in_outline(word: str, change: Callable[[list[str], list[int]], None]) -> Damage:
    """A change of the lines of a program, given the blocks that begin with a word in its operation
    "outline", at its first depth.
    """

    def changed(data: bytes) -> bytes:
        lines = data.decode().splitlines(keepends=True)
        start = next(k for k, line in enumerate(lines) if line.startswith("(operation outline"))
        plunge = next(k for k in range(start, len(lines)) if lines[k].startswith("G1 Z"))
        lift = next(k for k in range(plunge, len(lines)) if lines[k].startswith("G0 Z"))
        change(lines, [k for k in range(plunge, lift) if lines[k].startswith(word)])
        return "".join(lines).encode()

    return changed


def _longest_arc(lines: list[str], arcs: list[int]) -> int:
    """The arc that goes farthest, as its I and J show at the least: they are its radius."""
    return max(arcs[2:-2], key=lambda k: abs(_end(lines[k]) - _end(lines[k - 1])))


def _end(line: str) -> complex:
    words = dict(re.findall(r"([XYIJ])(-?[\d.]+)", line))
    return complex(float(words["X"]), float(words["Y"]))


def _shifted(line: str, letter: str, by: float) -> str:
    def moved(match: re.Match[str]) -> str:
        decimals = len(match.group(1).partition(".")[2])
        return f"{letter}{float(match.group(1)) + by:.{decimals}f}"

    return re.sub(rf"{letter}(-?[\d.]+)", moved, line)


def _reverse_arc(lines: list[str], arcs: list[int]) -> None:
    place = _longest_arc(lines, arcs)
    lines[place] = "G3" + lines[place][2:]


def _reverse_lead(lines: list[str], blocks: list[int]) -> None:
    """The arc onto the closed path comes from the other side, on the same circle."""
    place = blocks[1]
    lines[place] = {"G2": "G3", "G3": "G2"}[lines[place][:2]] + lines[place][2:]


def _lead_into_the_part(lines: list[str], blocks: list[int]) -> None:
    """Straight on after the closed path, over the cam axis."""
    last = max(k for k in blocks if lines[k].startswith(("G2", "G3")))
    lines[last] = "G1 X0.0000 Y0.0000\n"


def _move_end(lines: list[str], blocks: list[int]) -> None:
    """Across the path."""
    place = _longest_arc(lines, blocks)
    along = _end(lines[place + 1]) - _end(lines[place - 1])
    step = MOVED * 1j * along / abs(along)
    for letter, by in (("X", step.real), ("Y", step.imag)):
        lines[place] = _shifted(lines[place], letter, by)


def _leave_out_block(lines: list[str], arcs: list[int]) -> None:
    del lines[_longest_arc(lines, arcs)]


reverse_arc = in_outline("G2", _reverse_arc)
reverse_lead = in_outline("G", _reverse_lead)
lead_into_the_part = in_outline("G", _lead_into_the_part)
move_gcode_end = in_outline("G", _move_end)
leave_out_block = in_outline("G2", _leave_out_block)


def change_word(letter: str, by: float) -> Damage:
    def change(lines: list[str], arcs: list[int]) -> None:
        place = _longest_arc(lines, arcs)
        lines[place] = _shifted(lines[place], letter, by)

    return in_outline("G2", change)


def leave_out_line(start: str) -> Damage:
    """The last line that begins so is left out."""

    def leave_out(data: bytes) -> bytes:
        lines = data.decode().splitlines(keepends=True)
        del lines[max(k for k, line in enumerate(lines) if line.startswith(start))]
        return "".join(lines).encode()

    return leave_out


def cut_between_lines(data: bytes) -> bytes:
    """Cut short at the end of a line, so that every word is whole."""
    return data[: data.rindex(b"\n", 0, len(data) * 7 // 10) + 1]


# Meshes -------------------------------------------------------------------------------------------


def in_facets(change: Callable[[Any], None]) -> Damage:
    """The facets of an STL changed in place."""

    def changed(data: bytes) -> bytes:
        facets = np.frombuffer(data[PREFIX:], dtype=FACET).copy()
        change(facets)
        return data[:PREFIX] + facets.tobytes()

    return changed


def drop_facet(data: bytes) -> bytes:
    facets = np.delete(np.frombuffer(data[PREFIX:], dtype=FACET), 7)
    return data[: PREFIX - 4] + np.uint32(len(facets)).tobytes() + facets.tobytes()


def _flip(facets: Any) -> None:
    facets["corners"][7] = facets["corners"][7][::-1]


def _scale(facets: Any) -> None:
    facets["corners"] *= 25.4


def _mirror(facets: Any) -> None:
    """Still closed and turned outwards."""
    facets["corners"][:, :, 0] *= -1.0
    facets["corners"] = facets["corners"][:, ::-1].copy()


def _move_edge(facets: Any) -> None:
    """A corner at all facets that meet there, from face to face: a whole edge."""
    corners = facets["corners"]
    x, y, _ = corners.reshape(-1, 3)[_outermost(corners.reshape(-1, 3).astype(np.float64))]
    there = (corners[:, :, 0] == x) & (corners[:, :, 1] == y)
    corners[there, :2] *= np.float32(1.0 + MOVED / math.hypot(x, y))


def _tear(facets: Any) -> None:
    """One corner of one facet is moved."""
    facets["corners"][7, 0, 0] += np.float32(MOVED)


def _thicken(facets: Any) -> None:
    z = facets["corners"][:, :, 2]
    facets["corners"][:, :, 2] = np.where(z > 0.0, z + np.float32(MOVED), 0.0)


flip_facet = in_facets(_flip)
scale_stl = in_facets(_scale)
mirror_stl = in_facets(_mirror)
move_stl_vertex = in_facets(_move_edge)
tear_stl = in_facets(_tear)
thicken_stl = in_facets(_thicken)


def _outermost(points: FloatArray) -> int:
    return int(np.argmax(np.hypot(points[:, 0], points[:, 1])))


def in_model(change: Callable[[str], str]) -> Damage:
    """A change of the model inside a 3MF, packed again."""
    return partial(repacked, change=lambda path, text: change(text) if path == MODEL else text)


VERTEX = re.compile(r'<vertex x="([^"]+)" y="([^"]+)" z="([^"]+)" />')


def _scale_3mf(text: str) -> str:
    def scaled(match: re.Match[str]) -> str:
        x, y, z = (1.001 * float(value) for value in match.groups())
        return f'<vertex x="{x!r}" y="{y!r}" z="{z!r}" />'

    return VERTEX.sub(scaled, text)


def _move_3mf_vertex(text: str) -> str:
    points = np.array([[float(value) for value in row] for row in VERTEX.findall(text)])
    x, y, _ = points[_outermost(points)].tolist()
    share = 1.0 + MOVED / math.hypot(x, y)
    return text.replace(f'x="{x!r}" y="{y!r}"', f'x="{share * x!r}" y="{share * y!r}"')


move_3mf_vertex = in_model(_move_3mf_vertex)
scale_3mf = in_model(_scale_3mf)
drop_triangle = in_model(lambda text: re.sub(r"<triangle [^>]*/>", "", text, count=1))
flip_triangle = in_model(
    lambda text: re.sub(r'v1="(\d+)" v2="(\d+)"', r'v1="\2" v2="\1"', text, count=1)
)
change_3mf_unit = in_model(lambda text: text.replace('unit="millimeter"', 'unit="inch"'))


# STEP ---------------------------------------------------------------------------------------------


def swap_sense(kind: str) -> Damage:
    """The last entity of a kind that ends in a truth value has the other one."""

    def swapped(data: bytes) -> bytes:
        *_, last = re.finditer(rf"={kind}\(.*\.([TF])\.\);".encode(), data)
        other = b"F" if last.group(1) == b"T" else b"T"
        return data[: last.start(1)] + other + data[last.end(1) :]

    return swapped


def move_step_vertex(data: bytes) -> bytes:
    """The outermost vertex, outwards; the curves that end there stay where they are."""
    vertices = set(re.findall(rb"=VERTEX_POINT\('',#(\d+)\);", data))
    points = re.finditer(rb"\n#(\d+)=CARTESIAN_POINT\('',\((.*?),(.*?),(.*?)\)\);", data)
    places = [found for found in points if found[1] in vertices]
    outermost = max(places, key=lambda found: math.hypot(float(found[2]), float(found[3])))
    x, y = float(outermost[2]), float(outermost[3])
    share = 1.0 + MOVED / math.hypot(x, y)
    moved = f"{share * x!r},{share * y!r}".encode()
    return data[: outermost.start(2)] + moved + data[outermost.end(3) :]


def drop_step_face(data: bytes) -> bytes:
    """It is still in the file, but no longer in the shell."""
    return re.sub(rb"(=CLOSED_SHELL\('',\()#\d+,", rb"\g<1>", data)


def change_radius(data: bytes) -> bytes:
    """That of the first cylinder alone."""
    found = re.search(rb"=CYLINDRICAL_SURFACE\('',#\d+,(.*?)\);", data)
    assert found is not None
    radius = repr(float(found.group(1)) + MOVED).encode()
    return data[: found.start(1)] + radius + data[found.end(1) :]
