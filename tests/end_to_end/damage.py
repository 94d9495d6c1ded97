"""Deliberate damage to files of camgeo, as by a slip, an editor or a converter."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np

from camgeo.numeric.arrays import FloatArray
from tests.packages import repacked

TOLERANCE = 1e-3
"""At which the files are built [mm]."""

MOVED = 2.0 * TOLERANCE

Damage = Callable[[bytes], bytes]

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

PREFIX = 84

MODEL = "3D/3dmodel.model"


# Drawings -----------------------------------------------------------------------------------------


class Drawing:
    """The lines of a DXF, and where the vertices of its polylines stand."""

    def __init__(self, data: bytes) -> None:
        self.lines = data.decode().split("\n")
        codes = [line.strip() for line in self.lines]
        self.starts = [
            k + 1
            for k in range(0, len(codes) - 1, 2)
            if codes[k] == "0" and codes[k + 1] == "LWPOLYLINE"
        ]
        self.ends = [self._end(codes, start) for start in self.starts]

    @staticmethod
    def _end(codes: list[str], start: int) -> int:
        """Index of the group 0 after the entity whose name stands at `start`."""
        return next(k for k in range(start + 1, len(codes), 2) if codes[k] == "0")

    def values(self, polyline: int, code: int) -> list[int]:
        """Indices of the values of group `code` in a polyline."""
        inside = range(self.starts[polyline] + 1, self.ends[polyline], 2)
        return [k + 1 for k in inside if self.lines[k].strip() == str(code)]

    @property
    def longest(self) -> int:
        """The polyline with the most vertices on layer CUT, i.e. the outline."""
        cut = [k for k in range(len(self.starts)) if "CUT" in self._layer(k)]
        return max(cut, key=lambda k: len(self.values(k, 10)))

    def point(self, vertex: int) -> complex:
        """A vertex of the outline."""
        x, y = (self.lines[self.values(self.longest, code)[vertex]] for code in (10, 20))
        return complex(float(x), float(y))

    def _layer(self, polyline: int) -> str:
        return self.lines[self.values(polyline, 8)[0]]

    def data(self) -> bytes:
        return "\n".join(self.lines).encode()


def move_dxf_vertex(data: bytes) -> bytes:
    """Across the outline."""
    drawing = Drawing(data)
    before, point, after = (drawing.point(k) for k in (4, 5, 6))
    moved = point + MOVED * 1j * (after - before) / abs(after - before)
    for code, value in ((10, moved.real), (20, moved.imag)):
        drawing.lines[drawing.values(drawing.longest, code)[5]] = repr(value)
    return drawing.data()


def turn_bulge(data: bytes) -> bytes:
    drawing = Drawing(data)
    places = drawing.values(drawing.longest, 42)
    place = max(places, key=lambda k: abs(float(drawing.lines[k])))
    drawing.lines[place] = repr(-float(drawing.lines[place]))
    return drawing.data()


def leave_out_vertex(data: bytes) -> bytes:
    drawing = Drawing(data)
    polyline = drawing.longest
    x, following = drawing.values(polyline, 10)[6:8]
    (count,) = drawing.values(polyline, 90)
    drawing.lines[count] = str(int(drawing.lines[count]) - 1)
    del drawing.lines[x - 1 : following - 1]
    return drawing.data()


def leave_out_polyline(data: bytes) -> bytes:
    drawing = Drawing(data)
    polyline = next(k for k in range(len(drawing.starts)) if k != drawing.longest)
    del drawing.lines[drawing.starts[polyline] - 1 : drawing.ends[polyline]]
    return drawing.data()


def change_insunits(data: bytes) -> bytes:
    head, name, rest = data.partition(b"$INSUNITS")
    return head + name + re.sub(rb"^(\s*70\s+)\d", rb"\g<1>1", rest, count=1)


def mirror_dxf(data: bytes) -> bytes:
    drawing = Drawing(data)
    for polyline in range(len(drawing.starts)):
        for place in drawing.values(polyline, 10) + drawing.values(polyline, 42):
            drawing.lines[place] = repr(-float(drawing.lines[place]))
    return drawing.data()


def scale_dxf(data: bytes) -> bytes:
    drawing = Drawing(data)
    for polyline in range(len(drawing.starts)):
        for place in drawing.values(polyline, 10) + drawing.values(polyline, 20):
            drawing.lines[place] = repr(1.001 * float(drawing.lines[place]))
    return drawing.data()


def open_polyline(data: bytes) -> bytes:
    drawing = Drawing(data)
    (flags,) = drawing.values(drawing.longest, 70)
    drawing.lines[flags] = "0"
    return drawing.data()


def change_dxf_digit(data: bytes) -> bytes:
    """The second decimal of a coordinate, across the outline."""
    drawing = Drawing(data)
    count = len(drawing.values(drawing.longest, 10))
    level = max(range(1, count - 1), key=lambda k: _level(drawing, k))
    place = drawing.values(drawing.longest, 20)[level]
    drawing.lines[place] = _other_digit(drawing.lines[place], 2)
    return drawing.data()


def _level(drawing: Drawing, vertex: int) -> float:
    """How nearly the outline runs along x at a vertex."""
    along = drawing.point(vertex + 1) - drawing.point(vertex - 1)
    return abs(along.real) / abs(along)


def change_dxf_last_digit(data: bytes) -> bytes:
    drawing = Drawing(data)
    place = drawing.values(drawing.longest, 20)[8]
    text = drawing.lines[place].rstrip()
    drawing.lines[place] = text[:-1] + ("1" if text[-1] != "1" else "2")
    return drawing.data()


def _other_digit(number: str, decimal: int) -> str:
    place = number.index(".") + decimal
    digit = "1" if number[place] != "1" else "3"
    return number[:place] + digit + number[place + 1 :]


class Splines:
    """The lines of a DXF, and where the values of its longest SPLINE stand."""

    def __init__(self, data: bytes) -> None:
        self.lines = data.decode().split("\n")
        codes = [line.strip() for line in self.lines]
        starts = [
            k + 1
            for k in range(0, len(codes) - 1, 2)
            if codes[k] == "0" and codes[k + 1] == "SPLINE"
        ]
        ends = [next(k for k in range(s + 1, len(codes), 2) if codes[k] == "0") for s in starts]
        self.start, self.end = max(
            zip(starts, ends, strict=True), key=lambda span: span[1] - span[0]
        )

    def values(self, code: int) -> list[int]:
        inside = range(self.start + 1, self.end, 2)
        return [k + 1 for k in inside if self.lines[k].strip() == str(code)]

    def data(self) -> bytes:
        return "\n".join(self.lines).encode()


def move_control(data: bytes) -> bytes:
    """Moved so far that the curve moves by at least two tolerances: a control point weighs 2/3."""
    splines = Splines(data)
    controls = splines.values(10)
    place = controls[len(controls) // 2]
    splines.lines[place] = repr(float(splines.lines[place]) + 5.0 * MOVED)
    return splines.data()


def change_knot(data: bytes) -> bytes:
    """Half way to the knot after it."""
    splines = Splines(data)
    knots = splines.values(40)
    place, after = knots[len(knots) // 2 : len(knots) // 2 + 2]
    middle = 0.5 * (float(splines.lines[place]) + float(splines.lines[after]))
    splines.lines[place] = repr(middle)
    return splines.data()


def leave_out_spline(data: bytes) -> bytes:
    splines = Splines(data)
    del splines.lines[splines.start - 1 : splines.end]
    return splines.data()


# Programs -----------------------------------------------------------------------------------------


def _outline_blocks(data: bytes, word: str) -> tuple[list[str], list[int]]:
    """The lines of a program and the arcs of its operation "outline" at its first depth."""
    lines = data.decode().splitlines(keepends=True)
    start = next(k for k, line in enumerate(lines) if line.startswith("(operation outline"))
    plunge = next(k for k in range(start, len(lines)) if lines[k].startswith("G1 Z"))
    lift = next(k for k in range(plunge, len(lines)) if lines[k].startswith("G0 Z"))
    return lines, [k for k in range(plunge, lift) if lines[k].startswith(word)]


def _longest_arc(lines: list[str], arcs: list[int]) -> int:
    """The arc that goes farthest, as its I and J show at the least: they are its radius."""
    inner = arcs[2:-2]

    def span(k: int) -> float:
        x0, y0 = _xy(lines[k - 1])
        x, y = _xy(lines[k])
        return abs(complex(x - x0, y - y0))

    return max(inner, key=span)


def _xy(line: str) -> tuple[float, float]:
    words = dict(re.findall(r"([XYIJ])(-?[\d.]+)", line))
    return float(words["X"]), float(words["Y"])


def _shifted(line: str, letter: str, by: float) -> str:
    def moved(match: re.Match[str]) -> str:
        decimals = len(match.group(1).partition(".")[2])
        return f"{letter}{float(match.group(1)) + by:.{decimals}f}"

    return re.sub(rf"{letter}(-?[\d.]+)", moved, line)


def reverse_arc(data: bytes) -> bytes:
    lines, arcs = _outline_blocks(data, "G2")
    place = _longest_arc(lines, arcs)
    lines[place] = "G3" + lines[place][2:]
    return "".join(lines).encode()


def reverse_lead(data: bytes) -> bytes:
    """The arc onto the closed path comes from the other side, on the same circle."""
    lines, arcs = _outline_blocks(data, "G")
    lines[arcs[1]] = {"G2": "G3", "G3": "G2"}[lines[arcs[1]][:2]] + lines[arcs[1]][2:]
    return "".join(lines).encode()


def lead_into_the_part(data: bytes) -> bytes:
    """Straight on after the closed path, over the cam axis."""
    lines, arcs = _outline_blocks(data, "G")
    last = max(k for k in arcs if lines[k].startswith(("G2", "G3")))
    lines[last] = "G1 X0.0000 Y0.0000\n"
    return "".join(lines).encode()


def move_gcode_end(data: bytes) -> bytes:
    """Across the path."""
    lines, arcs = _outline_blocks(data, "G")
    place = _longest_arc(lines, arcs)
    along = complex(*_xy(lines[place + 1])) - complex(*_xy(lines[place - 1]))
    step = MOVED * 1j * along / abs(along)
    for letter, by in (("X", step.real), ("Y", step.imag)):
        lines[place] = _shifted(lines[place], letter, by)
    return "".join(lines).encode()


def change_word(letter: str, by: float) -> Damage:
    def change(data: bytes) -> bytes:
        lines, arcs = _outline_blocks(data, "G2")
        place = _longest_arc(lines, arcs)
        lines[place] = _shifted(lines[place], letter, by)
        return "".join(lines).encode()

    return change


def leave_out_block(data: bytes) -> bytes:
    lines, arcs = _outline_blocks(data, "G2")
    del lines[_longest_arc(lines, arcs)]
    return "".join(lines).encode()


def leave_out_line(start: str) -> Damage:
    """The last line that begins so is left out."""

    def leave_out(data: bytes) -> bytes:
        lines = data.decode().splitlines(keepends=True)
        del lines[max(k for k, line in enumerate(lines) if line.startswith(start))]
        return "".join(lines).encode()

    return leave_out


def replaced(old: bytes, new: bytes, count: int = 1) -> Damage:
    """The first `count` occurrences replaced, all of them for -1."""

    def replace(data: bytes) -> bytes:
        assert old in data
        return data.replace(old, new, count)

    return replace


def change_gcode_last_digit(data: bytes) -> bytes:
    return change_word("X", 1e-4)(data)


def cut_short(data: bytes) -> bytes:
    return data[: len(data) * 7 // 10]


def cut_between_lines(data: bytes) -> bytes:
    """Cut short at the end of a line, so that every word is whole."""
    return data[: data.rindex(b"\n", 0, len(data) * 7 // 10) + 1]


# Meshes -------------------------------------------------------------------------------------------


def _facets(data: bytes) -> np.ndarray[tuple[int], np.dtype[np.void]]:
    return np.frombuffer(data[PREFIX:], dtype=FACET).copy()


def _stl(data: bytes, facets: np.ndarray[tuple[int], np.dtype[np.void]]) -> bytes:
    return data[: PREFIX - 4] + np.uint32(len(facets)).tobytes() + facets.tobytes()


def drop_facet(data: bytes) -> bytes:
    return _stl(data, np.delete(_facets(data), 7))


def flip_facet(data: bytes) -> bytes:
    facets = _facets(data)
    facets["corners"][7] = facets["corners"][7][::-1]
    return _stl(data, facets)


def scale_stl(data: bytes) -> bytes:
    facets = _facets(data)
    facets["corners"] *= 25.4
    return _stl(data, facets)


def mirror_stl(data: bytes) -> bytes:
    """Still closed and turned outwards."""
    facets = _facets(data)
    facets["corners"][:, :, 0] *= -1.0
    facets["corners"] = facets["corners"][:, ::-1].copy()
    return _stl(data, facets)


def move_stl_vertex(data: bytes) -> bytes:
    """At all facets that meet there, from face to face: a whole edge."""
    facets = _facets(data)
    corners = facets["corners"]
    place = _outermost(corners.reshape(-1, 3).astype(np.float64))
    there = (corners[:, :, :2] == corners.reshape(-1, 3)[place, :2]).all(axis=2)
    corners[there, :2] *= np.float32(
        1.0 + MOVED / np.linalg.norm(corners.reshape(-1, 3)[place, :2])
    )
    return _stl(data, facets)


def tear_stl(data: bytes) -> bytes:
    """One corner of one facet is moved."""
    facets = _facets(data)
    facets["corners"][7, 0, 0] += np.float32(MOVED)
    return _stl(data, facets)


def thicken_stl(data: bytes) -> bytes:
    facets = _facets(data)
    corners = facets["corners"]
    corners[:, :, 2] = np.where(corners[:, :, 2] > 0.0, corners[:, :, 2] + np.float32(MOVED), 0.0)
    return _stl(data, facets)


def _outermost(points: FloatArray) -> int:
    return int(np.argmax(np.hypot(points[:, 0], points[:, 1])))


def in_model(change: Callable[[str], str]) -> Damage:
    """A change of the model inside a 3MF, packed again."""

    def changed(path: str, content: str) -> str:
        if path != MODEL:
            return content
        after = change(content)
        assert after != content
        return after

    return lambda data: repacked(data, changed)


VERTEX = re.compile(r'<vertex x="([^"]+)" y="([^"]+)" z="([^"]+)" />')


def _move_3mf_vertex(text: str) -> str:
    points = np.array([[float(value) for value in row] for row in VERTEX.findall(text)])
    x, y, _ = points[_outermost(points)]
    share = 1.0 + MOVED / float(np.hypot(x, y))

    def moved(match: re.Match[str]) -> str:
        here, there = float(match.group(1)), float(match.group(2))
        if (here, there) != (x, y):
            return match.group(0)
        return f'<vertex x="{share * here!r}" y="{share * there!r}" z="{match.group(3)}" />'

    return VERTEX.sub(moved, text)


def _scale_3mf(text: str) -> str:
    def scaled(match: re.Match[str]) -> str:
        x, y, z = (1.001 * float(value) for value in match.groups())
        return f'<vertex x="{x!r}" y="{y!r}" z="{z!r}" />'

    return VERTEX.sub(scaled, text)


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
    places = {}
    for number in re.findall(rb"=VERTEX_POINT\('',#(\d+)\);", data):
        found = re.search(rb"\n#%s=CARTESIAN_POINT\('',\((.*?)\)\);" % number, data)
        assert found is not None
        places[number] = found
    points = {k: [float(x) for x in found.group(1).split(b",")] for k, found in places.items()}
    outermost = max(points, key=lambda k: math.hypot(*points[k][:2]))
    x, y, z = points[outermost]
    share = 1.0 + MOVED / math.hypot(x, y)
    found = places[outermost]
    moved = f"{share * x!r},{share * y!r},{z:.1f}".encode()
    return data[: found.start(1)] + moved + data[found.end(1) :]


def drop_step_face(data: bytes) -> bytes:
    """It is still in the file, but no longer in the shell."""
    return re.sub(rb"(=CLOSED_SHELL\('',\()#\d+,", rb"\g<1>", data)


def change_radius(data: bytes) -> bytes:
    """That of the first cylinder alone."""
    found = re.search(rb"=CYLINDRICAL_SURFACE\('',#\d+,(.*?)\);", data)
    assert found is not None
    radius = repr(float(found.group(1)) + MOVED).encode()
    return data[: found.start(1)] + radius + data[found.end(1) :]
