"""SVG at true size: the part's boundaries as closed paths of lines and arcs, one unit 1 mm.

Width and height state millimetres and the view box the same numbers, so programs that convert 96
pixels to an inch take no part in it. Y points down in SVG; numbers are mirrored, nothing is
transformed. One group for each layer of `camgeo_export.reading`, hairlines without fill.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final
from xml.etree import ElementTree as ET
from xml.sax.saxutils import escape

import numpy as np

from camgeo.design.product import Product, display_title
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.foreign import Outlines
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import largest_radius
from camgeo.part.part import written_contour
from camgeo.reading import CONTOURS, Limits, beyond, check_size, parse_number
from camgeo.scene.formats.format import CUT_SVG
from camgeo.units import LengthUnit, counted
from camgeo_export.reading import CUT, boundaries_by_layer, part_layers
from camgeo_export.verify.plane import deviation

SVG: Final = Limits("SVG drawing", 16_000_000)

SVG_ELEMENTS: Final = 10_000
"""Elements of an SVG drawing; one of ours has one for each boundary."""

SVG_PIECES: Final = 50_000
"""Lines and arcs of an SVG drawing."""

WIDEST: Final = 0.5 * math.pi
"""Widest arc [rad]: an arc is given by its ends and its radius, from which the centre of one near
half a turn cannot be found."""

DECIMALS: Final = 15
"""Decimals to which coordinates are rounded, so that 0 with a rounding error is written as 0; far
below any tolerance."""

MARGIN: Final = 1.0
"""Margin around the part [mm]."""

HAIRLINE: Final = "0.01"
"""Width of the lines [mm], which laser cutters take as a cut."""

THROUGH, NOT_THROUGH = "#ff0000", "#0000ff"
"""Colours of what is cut through, and of what is not."""


class CutSvgWriter:
    """Writes the part as an SVG at true size."""

    format = CUT_SVG

    def write(self, product: Product, tolerance: float) -> Written:
        """The drawing in mm, whatever the unit of the scene; all of it within `tolerance` [mm]."""
        effort = product.drawn.effort
        layers: dict[str, list[Contour]] = {
            name: [
                written_contour(boundary, "arcs", effort, tolerance, WIDEST).contour
                for boundary in boundaries
            ]
            for name, boundaries in boundaries_by_layer(product).items()
        }
        curves = [contour for contours in layers.values() for contour in contours]
        pieces = sum(map(len, curves))
        if pieces > SVG_PIECES:
            raise FileError(
                f"the drawing would have {counted(pieces, 'piece')}; at most {SVG_PIECES:,} are"
                " allowed in a drawing that is read; a larger tolerance needs fewer"
            )
        side = math.ceil(max(map(largest_radius, curves)) + MARGIN)
        size = f'width="{2 * side}mm" height="{2 * side}mm"'
        box = f'viewBox="{-side} {-side} {2 * side} {2 * side}"'
        origin = f"camgeo {product.version}; scene {product.scene_hash}"
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" version="1.1" {size} {box}>',
            f"<title>{escape(display_title(product))}</title>",
            f"<desc>{origin}; tolerance {tolerance!r} mm</desc>",
        ]
        for name, contours in layers.items():
            colour = THROUGH if name == CUT else NOT_THROUGH
            lines += [
                f'<g id="{name}" fill="none" stroke="{colour}" stroke-width="{HAIRLINE}">',
                *(f'<path d="{path_data(contour)}"/>' for contour in contours),
                "</g>",
            ]
        arcs = sum(contour.arc_count for contour in curves)
        facts: dict[str, int | float | str] = {
            "boundaries": len(curves), "arcs": arcs, "lines": pieces - arcs,
        }  # fmt: skip
        return Written("\n".join([*lines, "</svg>", ""]).encode(), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the drawing back: largest proved deviation [mm] of all that is drawn.

        Raises FileError if the drawing is incomplete, foreign or not at true size.
        """
        drawing = read_drawing(data)
        layers = boundaries_by_layer(product)
        if drawing.scale != 1.0:
            raise FileError(f"a unit of the drawing is {drawing.scale:g} mm, not 1 mm")
        foreign = [name for name in drawing.layers if name not in layers]
        if foreign:
            group = foreign[0][:40]
            raise FileError(f"a contour in the group {group!r} is not part of the drawing")
        return max(
            deviation(drawing.layers.get(name, ()), boundaries)
            for name, boundaries in layers.items()
        )


def path_data(contour: Contour) -> str:
    """The data of a path, in millimetres, y downward."""
    pieces = zip(
        contour.ends.tolist(), contour.sweeps.tolist(), contour.radii.tolist(), strict=True
    )
    words = [f"M{_point(complex(contour.vertices[0]))}"]
    for end, sweep, radius in pieces:
        if sweep:
            turn = 0 if sweep > 0.0 else 1  # counter-clockwise is against growing angles here
            size = _decimal(radius)
            words.append(f"A{size} {size} 0 0 {turn} {_point(end)}")
        else:
            words.append(f"L{_point(end)}")
    return " ".join([*words, "Z"])


def _point(point: complex) -> str:
    return f"{_decimal(point.real)} {_decimal(-point.imag)}"


def _decimal(value: float) -> str:
    """The shortest decimal that reads back the same, without an exponent."""
    rounded = round(value, DECIMALS) + 0.0  # + 0.0 turns -0.0 into 0.0
    return np.format_float_positional(rounded, trim="-")


WRITER = CutSvgWriter()


# -- reader ----------------------------------------------------------------------------------------
# Closed contours of lines and arcs in an SVG drawing, at the size that it states.
#
# Read are paths of lines and circular arcs, polygons and circles, in groups. What would need
# another size or place (transformations, other units along x than along y) and other curves are
# refused.


NAMESPACE: Final = "{http://www.w3.org/2000/svg}"

MM_PER_UNIT: Final = {
    "mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.0, "pc": 25.4 / 6.0,
    "px": 25.4 / 96.0, "": 25.4 / 96.0,
}  # fmt: skip
"""Millimetres of the units of CSS; a number without one counts in pixels, 96 to the inch."""

LENGTH: Final = re.compile(r"\s*([-+.0-9eE]{1,60}?)\s*([a-z]{0,2})\s*")

TOKEN: Final = re.compile(r"[A-Za-z]|[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

SEPARATOR: Final = re.compile(r"[\s,]*")

COUNTS: Final = {"M": 2, "L": 2, "H": 1, "V": 1, "A": 7, "Z": 0}
"""Numbers after each letter of a path."""

SILENT: Final = ("title", "desc", "metadata", "defs", "style", "namedview")
"""Elements that draw nothing by themselves; they are skipped with all their contents."""

ROUND: Final = 1e-9
"""Radii of an arc along x and y, and scales, that differ by a larger fraction are different."""

JOINED: Final = 1e-12
"""An end this close to the start, as a fraction of the path's extent, closes a path as Z does."""


@dataclass(frozen=True, slots=True)
class SvgDrawing:
    """A drawing that was read.

    Attributes
    ----------
    scale : millimetres per unit of the drawing.
    note : the text of its description.
    layers : closed contours [mm], y upward and counter-clockwise, by the id of the group around
        them; those without a group have the layer "".
    """

    scale: float
    note: str
    layers: dict[str, list[Contour]] = field(default_factory=dict)

    @property
    def contours(self) -> tuple[Contour, ...]:
        """All contours."""
        return tuple(contour for contours in self.layers.values() for contour in contours)


def read_drawing(data: bytes, name: str = "the drawing") -> SvgDrawing:
    """The drawing in the file `name`; FileError if it is not an SVG that can be read."""
    root = _root(data, name)
    scale = _scale(root, name)
    drawing = SvgDrawing(
        scale, next((element.text or "" for element in root.iter(f"{NAMESPACE}desc")), "")
    )
    pieces = count = 0
    for layer, item in _visible_elements(root, "", name):
        for contour in _contours(item, scale, name):
            drawing.layers.setdefault(layer, []).append(contour)
            count, pieces = count + 1, pieces + len(contour)
            if count > CONTOURS:
                raise beyond(name, counted(count, "closed contour"), CONTOURS, SVG)
            if pieces > SVG_PIECES:
                raise beyond(
                    name, counted(pieces, "line or arc", "lines and arcs"), SVG_PIECES, SVG
                )
    if not drawing.layers:
        raise FileError(f"{name}: no contour found; camgeo reads paths, polygons and circles")
    return drawing


def check_xml(data: bytes, name: str) -> None:
    """Raise FileError unless the file may be parsed: UTF-8, without references, not too large."""
    check_size(len(data), SVG, name)
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise FileError(f"{name}: has a document type declaration, which is not allowed")
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        raise FileError(f"{name}: is not encoded as UTF-8") from None
    head = data[:200].lower()
    if b"\0" in data or (b"encoding=" in head and b"utf-8" not in head):
        raise FileError(f"{name}: is not encoded as UTF-8")
    # Bounds elements and attributes before anything is parsed: an element has two tags at most.
    count = data.count(b"<")
    if count > 2 * SVG_ELEMENTS:
        raise beyond(name, counted(count, "tag"), 2 * SVG_ELEMENTS, SVG)
    if data.count(b"=") > 20 * SVG_ELEMENTS:
        raise beyond(name, counted(data.count(b"="), "attribute"), 20 * SVG_ELEMENTS, SVG)


def _root(data: bytes, name: str) -> ET.Element:
    check_xml(data, name)
    try:
        root = ET.parse(io.BytesIO(data)).getroot()
    except (SyntaxError, ValueError) as error:
        raise FileError(f"{name}: is not XML: {error}") from None
    if root.tag != f"{NAMESPACE}svg":
        raise FileError(f"{name}: is not an SVG drawing: its root is {root.tag[:60]}")
    return root


def _scale(root: ET.Element, name: str) -> float:
    """Millimetres per unit of the drawing."""
    sides = [_length(root.get(key, ""), key, name) for key in ("width", "height")]
    box = root.get("viewBox")
    if box is None:
        return MM_PER_UNIT["px"]
    numbers = _numbers(box, "viewBox", name)
    if len(numbers) != 4 or min(numbers[2:]) <= 0.0:
        raise FileError(f"{name}: viewBox must have four numbers, its sides above 0")
    scales = [side / box_side for side, box_side in zip(sides, numbers[2:], strict=True)]
    if abs(scales[0] - scales[1]) > ROUND * scales[0]:
        raise FileError(f"{name}: width, height and viewBox scale x and y differently")
    return scales[0]


def _length(text: str, key: str, name: str) -> float:
    """A length [mm] of the root."""
    match = LENGTH.fullmatch(text) if len(text) <= 100 else None
    number = None if match is None else parse_number(match[1])
    if match is None or number is None or match[2] not in MM_PER_UNIT or number <= 0.0:
        raise FileError(f"{name}: states no {key} as a length: {text[:40]!r}")
    return number * MM_PER_UNIT[match[2]]


def _visible_elements(root: ET.Element, layer: str, name: str) -> Iterator[tuple[str, ET.Element]]:
    """The elements that are drawn, each with the id of the innermost group that has one."""
    waiting = [(layer, root)]
    while waiting:
        group, element = waiting.pop()
        for item in element:
            kind = str(item.tag).removeprefix(NAMESPACE)
            if kind.rpartition("}")[2] in SILENT:
                continue
            if item.get("transform", "").strip() or "transform" in item.get("style", ""):
                raise FileError(f"{name}: {kind} has a transformation, which cannot be read")
            if kind == "g":
                waiting.append((item.get("id", group), item))
            elif kind in ("path", "polygon", "circle"):
                yield group, item
            else:
                raise FileError(
                    f"{name}: the element {kind[:40]} cannot be read; allowed are paths, polygons"
                    " and circles"
                )


def _contours(item: ET.Element, scale: float, name: str) -> Iterator[Contour]:
    """The closed contours of an element [mm], counter-clockwise, one by one."""
    kind = item.tag.removeprefix(NAMESPACE)
    if kind == "circle":
        x, y, r = (_number(item.get(key, "0"), key, name) for key in ("cx", "cy", "r"))
        if not r > 0.0:
            raise FileError(f"{name}: a circle needs a radius above 0")
        yield Contour.circle(r * scale, complex(x, -y) * scale)
    elif kind == "polygon":
        numbers = _numbers(item.get("points", ""), "points", name)
        if len(numbers) % 2:
            raise FileError(f"{name}: points has an odd number of coordinates")
        corners = [complex(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
        yield _contour(corners, [0.0] * len(corners), scale, name)
    else:
        for points, sweeps in _subpaths(_words(item.get("d", ""), name), name):
            yield _contour(points, sweeps, scale, name)


def _contour(
    points: Sequence[complex], sweeps: Sequence[float], scale: float, name: str
) -> Contour:
    # y points down in SVG: mirroring it reverses the sense of all arcs.
    vertices: ComplexArray = np.conj(np.array(points, dtype=np.complex128)) * np.complex128(scale)
    if len(points) < 2:
        raise FileError(f"{name}: a contour encloses nothing")
    contour = Contour.through(vertices, -np.array(sweeps))
    if not math.isfinite(contour.area) or contour.area == 0.0:
        raise FileError(f"{name}: a contour encloses no area")
    return contour.counter_clockwise()


def _words(text: str, name: str) -> list[str]:
    """The letters and numbers of path data."""
    words, place = [], 0
    for token in TOKEN.finditer(text):
        gap = SEPARATOR.match(text, place)
        if gap is None or gap.end() < token.start():
            break
        words.append(token[0])
        place = token.end()
        if len(words) > 8 * SVG_PIECES:
            raise beyond(name, "many numbers in a path", 8 * SVG_PIECES, SVG)
    if text[place:].strip(" \t\r\n,"):
        raise FileError(f"{name}: path data cannot be read at {text[place : place + 20]!r}")
    return words


def _subpaths(words: Sequence[str], name: str) -> Iterator[tuple[list[complex], list[float]]]:
    """Vertices and sweeps of each closed subpath, y downward, in units of the drawing."""
    points: list[complex] = []
    sweeps: list[float] = []
    here = start = 0j
    letter, place = "", 0
    while place < len(words):
        if words[place].isalpha():
            letter, place = words[place], place + 1
        kind, relative = letter.upper(), letter.islower()
        if kind not in COUNTS or (kind != "M" and not points and kind != "Z"):
            raise FileError(
                f"{name}: {letter or 'a number'} is not allowed at this point of a path, which"
                " begins with M and continues with M, L, H, V, A or Z"
            )
        numbers = [_number(word, kind, name) for word in words[place : place + COUNTS[kind]]]
        if len(numbers) < COUNTS[kind]:
            raise FileError(f"{name}: {letter} in a path needs {counted(COUNTS[kind], 'number')}")
        place += COUNTS[kind]
        if kind == "Z":
            yield from _close_subpath(points, sweeps, here, start, name, ended=True)
            here, points, sweeps = start, [start], []
            # No numbers may follow Z.
            letter = ""
            continue
        end = _end(kind, numbers, here if relative else 0j, here)
        if kind == "M":
            yield from _close_subpath(points, sweeps, here, start, name, ended=False)
            start, points, sweeps = end, [end], []
            letter = "l" if relative else "L"  # of further numbers
        elif end != here:
            sweeps.append(_sweep(numbers, here, end, name) if kind == "A" else 0.0)
            points.append(end)
        here = end
    yield from _close_subpath(points, sweeps, here, start, name, ended=False)


def _end(kind: str, numbers: Sequence[float], origin: complex, here: complex) -> complex:
    if kind == "H":
        return complex(origin.real + numbers[0], here.imag)
    if kind == "V":
        return complex(here.real, origin.imag + numbers[0])
    return origin + complex(*numbers[-2:])


def _close_subpath(
    points: list[complex],
    sweeps: list[float],
    here: complex,
    start: complex,
    name: str,
    *,
    ended: bool,
) -> Iterator[tuple[list[complex], list[float]]]:
    """The subpath as a closed one: `ended` says that Z closes it; otherwise its end must coincide
    with its start.
    """
    if not sweeps:
        return
    near = abs(here - start) <= JOINED * max(abs(start), abs(here))
    if not (ended or near):
        raise FileError(f"{name}: a path is not closed")
    if near:
        yield points[:-1], sweeps
    else:
        yield points, [*sweeps, 0.0]


def _sweep(numbers: Sequence[float], start: complex, end: complex, name: str) -> float:
    """The angle that an arc turns [rad], positive towards growing angles, y downward.

    A radius that is too small for the chord counts as half of it (SVG 2, 9.5.1).
    """
    across, down, _, large, positive = numbers[:5]
    radius = abs(across)
    if abs(radius - abs(down)) > ROUND * radius:
        raise FileError(f"{name}: an elliptical arc cannot be read; rx and ry must be equal")
    if large not in (0.0, 1.0) or positive not in (0.0, 1.0):
        raise FileError(f"{name}: flags of an arc must be 0 or 1")
    if radius == 0.0:
        return 0.0
    # Half the angle of the smaller one of the two arcs with these ends.
    half = math.asin(min(1.0, 0.5 * abs(end - start) / radius))
    turned = 2.0 * (math.pi - half if large else half)
    return turned if positive else -turned


def _number(text: str, what: str, name: str) -> float:
    number = parse_number(text)
    if number is None:
        raise FileError(f"{name}: {what} has {text[:40]!r}, which is not a number that can be read")
    return number


def _numbers(text: str, what: str, name: str) -> list[float]:
    words = text.replace(",", " ").split()
    if len(words) > 2 * SVG_PIECES:
        raise beyond(name, f"many numbers in {what}", 2 * SVG_PIECES, SVG)
    return [_number(word, what, name) for word in words]


# -- contours -------------------------------------------------------------------------------------
# Contours of an SVG drawing at true size, for replay.


class SvgReader:
    """Reads contours from SVG; its groups with an id are its layers."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Callable[[str], object] = lambda _: None,
    ) -> Outlines:
        """The closed contours [mm], counter-clockwise, the largest first, of the group `layer`;
        without one of the part's edges if there is a group CUT, else all.

        Raises FileError if the drawing is not read, has no such group, or a unit is given: its size
        is stated.
        """
        drawing = read_drawing(data, name)
        if unit is not None:
            raise FileError(f"{name}: an SVG drawing states its size; leave out the unit {unit}")
        if layer is not None and layer not in drawing.layers:
            known = ", ".join(repr(group) for group in sorted(drawing.layers) if group) or "none"
            raise FileError(f"{name}: has no contour in a group {layer!r}; groups: {known[:200]}")
        names = set(drawing.layers) if layer is None else {layer}
        if CUT in names:
            names = part_layers(names)
        contours = [contour for name in names for contour in drawing.layers[name]]
        # Which of two equal ones is first, their first vertices say.
        contours.sort(
            key=lambda curve: (-curve.area, curve.vertices[0].real, curve.vertices[0].imag)
        )
        return Outlines(tuple(contours))


READER = SvgReader()
