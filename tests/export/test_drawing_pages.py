"""Pages of a sheet: SVG and PDF draw the same, and that is what the sheet has, grain by grain."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from fontTools.pens.recordingPen import RecordingPen  # type: ignore[import-untyped]  # has no types
from fontTools.svgLib.path import parse_path  # type: ignore[import-untyped]  # has no types

from camgeo.numeric.arrays import ComplexArray
from camgeo.pictures.sheet.marks import Chain, Filled, Label, Round
from camgeo.pictures.sheet.sheet import sheets_of
from camgeo_export.drawing.writer import LAYERS, PDF, SVG
from tests.export.test_drawing import placed, product, streams
from tests.sheet.sheets import TOLERANCE

KINDS = ("inch", "bolts")

GRAIN = 0.005
"""Of all coordinates [mm]."""

TOLD = {"m": "moveTo", "l": "lineTo", "c": "curveTo", "h": "closePath"}

SHARES = np.array([0.25, 0.5, 0.75])

Runs = list[tuple[list[complex], list[complex]]]
"""Of each run of lines and curves its ends, and places a quarter, a half and three quarters of the
way along each curve [grains]; y upwards."""


def runs(drawn: Iterable[tuple[str, Any]], at: Callable[[complex], complex]) -> Runs:
    """The runs of what a pen was told."""
    found: Runs = []
    here = 0j
    for told, points in drawn:
        if told == "closePath":
            ends = found[-1][0]
            ends += ends[:1] if ends[-1] != ends[0] else ()
        elif points:
            *own, last = points if told != "arcTo" else points[-1:]
            places = [here, *(complex(*each) for each in own), complex(*last)]
            if told == "moveTo":
                found.append(([], []))
            elif told != "lineTo":
                along = arc_of(here, places[-1], points) if told == "arcTo" else bezier(places)
                found[-1][1].extend(map(at, along))
            here = places[-1]
            found[-1][0].append(at(here))
    return found


def svg_runs(text: str, at: Callable[[complex], complex]) -> Runs:
    """The runs of a path, as fontTools reads it."""
    pen = RecordingPen()
    pen.arcTo = lambda *told: pen.value.append(("arcTo", told))
    parse_path(text, pen)
    return runs(pen.value, at)


def arc_of(start: complex, end: complex, numbers: Sequence[Any]) -> Iterator[complex]:
    """Places along an arc (SVG 2, appendix B.2.4)."""
    radius, _, _, large, positive, _ = numbers
    half = 0.5 * (start - end)
    root = math.sqrt(max(0.0, radius**2 / abs(half) ** 2 - 1.0))
    sign = -1.0 if large == positive else 1.0
    centre = 0.5 * (start + end) + sign * root * complex(half.imag, -half.real)
    turn = float(np.angle((end - centre) / (start - centre))) % (2.0 * math.pi)
    turn = turn if positive else turn - 2.0 * math.pi
    yield from (centre + (start - centre) * np.exp(1j * turn * SHARES)).tolist()


def bezier(points: list[complex]) -> list[complex]:
    """Places along a curve, by de Casteljau's algorithm."""
    rows = [np.full(3, each) for each in points]
    while len(rows) > 1:
        rows = [(1.0 - SHARES) * a + SHARES * b for a, b in pairwise(rows)]
    found: list[complex] = rows[0].tolist()
    return found


def pdf_runs(text: str, at: complex = 0j) -> Runs:
    """The runs of operators m, l, c and h."""
    drawn = []
    for places, word in re.findall(r"((?:-?\d+\s+)*)([mlch])\b", text):
        drawn.append((TOLD[word], np.array(places.split(), dtype=float).reshape(-1, 2).tolist()))
    return runs(drawn, lambda place: at + place)


@cache
def pages(name: str) -> tuple[bytes, bytes]:
    return tuple(each.write(product(name), TOLERANCE).data for each in (SVG, PDF))  # type: ignore[return-value]  # of two


def svg_page(name: str) -> tuple[dict[int, Runs], list[Runs]]:
    """Lines by their widths, and filled outlines in their places."""
    root = ET.fromstring(pages(name)[0])
    high = float(str(root.get("viewBox")).split()[3])

    def upwards(point: complex) -> complex:
        return complex(point.real, high - point.imag)

    lines, shapes, filled = {}, {}, []
    for each in root.iter():
        tag = each.tag.rpartition("}")[2]
        if tag == "path" and each.get("stroke-width"):
            lines[int(each.get("stroke-width", ""))] = svg_runs(each.get("d", ""), upwards)
        elif tag == "path":
            shapes[each.get("id")] = each.get("d", "")
        elif tag == "use":
            at = complex(float(each.get("x", "")), float(each.get("y", "")))
            shape = shapes[each.get("href", "")[1:]]
            filled.append(svg_runs(shape, lambda point, at=at: upwards(point + at)))  # type: ignore[misc]  # bound now
    return lines, filled


def pdf_page(name: str) -> tuple[dict[int, Runs], list[Runs]]:
    (text,) = streams(pages(name)[1])
    across, _, _, up, *_ = map(float, text.split()[:6])
    assert (across, up) == pytest.approx([GRAIN * 72.0 / 25.4] * 2, rel=1e-6)
    lines = {int(width): pdf_runs(own) for width, own in re.findall(r"(\d+) w\n(.*?)\nS", text,
                                                                    re.DOTALL)}  # fmt: skip
    letters = re.findall(r"q 1 0 0 1 (-?\d+) (-?\d+) cm (.*?) f Q", text)
    return lines, [pdf_runs(own, complex(int(x), int(y))) for x, y, own in letters]


@pytest.mark.parametrize("name", KINDS)
def test_both_formats_draw_the_same(name: str) -> None:
    """Ends of lines to the grain; curves of a PDF are cubics, and have more of them."""
    (one, filled), (other, also) = svg_page(name), pdf_page(name)
    assert one.keys() == other.keys()
    for width, runs in one.items():
        assert len(runs) == len(other[width])
        for (ends, along), (cubics, inner) in zip(runs, other[width], strict=True):
            if not along:
                assert ends == cubics
                continue
            everything = np.array([*cubics, *inner])
            for places, off in ((ends, 1.0), (along, 200.0)):
                away = np.abs(everything[:, None] - np.array(places))
                assert np.max(np.min(away, axis=0)) <= off
            circle = circle_of(ends, along)
            if circle is not None:
                middle, radius = circle
                assert np.max(np.abs(np.abs(everything - middle) - radius)) <= 1.5
    assert len(filled) == len(also) > 30
    for letter, same in zip(filled, also, strict=True):
        assert [ends[0] for ends, _ in letter] == [ends[0] for ends, _ in same]
        for (ends, along), (more, inner) in zip(letter, same, strict=True):
            away = np.array([*ends, *along]) - np.array([*more, *inner])
            assert np.max(np.abs(away)) <= 1.5


def circle_of(ends: list[complex], along: list[complex]) -> tuple[complex, float] | None:
    """Middle and radius of a run that is a whole circle of quarters."""
    if len(ends) != 5 or len(along) != 12:
        return None
    middle = complex(np.mean(ends[:4]))
    radii = np.abs(np.array([*ends, *along]) - middle)
    return (middle, float(np.mean(radii))) if np.ptp(radii) <= 3.0 else None


@pytest.mark.parametrize("name", KINDS)
def test_all_chains_of_the_sheet_are_on_the_page(name: str) -> None:
    """Each with its width: as many runs as chains at least, and each vertex, to half a grain."""
    (sheet,) = sheets_of(product(name), TOLERANCE)
    lines, _ = svg_page(name)
    where = {width: Counter(each for ends, _ in runs for each in ends)
             for width, runs in lines.items()}  # fmt: skip
    there = {width: np.array(list(each)) for width, each in where.items()}
    counts: Counter[int] = Counter()
    for mark, at, scale in placed(sheet):
        if isinstance(mark, Chain) and mark.layer != "HIDDEN":
            vertices: ComplexArray = mark.vertices
        elif isinstance(mark, Round):
            vertices = mark.centre + mark.radius * np.exp(0.5j * np.pi * np.arange(4))
        else:
            continue
        width = round(0.01 * LAYERS[mark.layer][2] / GRAIN)
        points = (at + scale * vertices) / GRAIN
        whole = np.rint(points.real) + 1j * np.rint(points.imag)
        if np.ptp(whole.real) or np.ptp(whole.imag):
            counts[width] += 1
            near = np.min(np.abs(there[width][:, None] - points), axis=0)
            assert np.max(near) <= math.sqrt(0.5) + 1e-6
    for width, count in counts.items():
        assert len(lines[width]) >= count
    assert max(lines) == round(0.7 / GRAIN)
    for runs in lines.values():  # a single line does not lead back
        assert all(len(ends) == 2 for ends, along in runs if len(set(ends)) == 2 and not along)


@pytest.mark.parametrize("name", KINDS)
def test_letters_and_arrows_are_where_the_sheet_has_them(name: str) -> None:
    """A text begins, has its middle or ends at its place; what is filled has its own corners."""
    (sheet,) = sheets_of(product(name), TOLERANCE)
    _, filled = svg_page(name)
    corners = [np.array(ends) for runs in filled for ends, _ in runs]
    firsts = np.array([ends[0] for runs in filled for ends, _ in runs])
    for mark, at, scale in placed(sheet):
        if isinstance(mark, Filled):
            wanted = np.array([(at + scale * each) / GRAIN for each in mark.corners])
            assert any(
                len(each) == len(wanted) + 1 and np.max(np.abs(each[:-1] - wanted)) <= 1.0
                for each in corners
            )
        elif isinstance(mark, Label) and mark.text.strip():
            place, size = (at + scale * mark.at) / GRAIN, mark.height / GRAIN
            along = (firsts - place) * np.exp(-1j * mark.angle)
            low, high = {"left": (-0.5, 2.0), "centre": (-2.0, 2.0), "right": (-2.0, 0.5)}[
                mark.across
            ]
            near = (along.real >= low * size) & (along.real <= high * size)
            assert np.any(near & (along.imag > -0.5 * size) & (along.imag < 1.5 * size)), mark
    frame = np.array([sheet.width, sheet.height]) / GRAIN
    assert np.all((firsts.real > 0.0) & (firsts.real < frame[0]))
    assert np.all((firsts.imag > 0.0) & (firsts.imag < frame[1]))


@pytest.mark.parametrize("name", KINDS)
def test_a_pdf_has_its_objects_where_its_table_says(name: str) -> None:
    data = pages(name)[1]
    (sheet,) = sheets_of(product(name), TOLERANCE)
    assert PDF.write(product(name), TOLERANCE).data == data
    assert len(data) < 120_000
    assert b"Date" not in data
    assert data.startswith(b"%PDF-1.4\n%")
    start = int(data[data.rindex(b"startxref\n") + 10 :].split()[0])
    table = data[start:].decode("ascii")
    assert table.startswith("xref\n0 6\n0000000000 65535 f \n")
    places = [int(each) for each in re.findall(r"(\d{10}) 00000 n \n", table)]
    assert len(places) == 5
    for number, place in enumerate(places, start=1):
        assert data[place:].startswith(f"{number} 0 obj\n<<".encode())
    assert "<< /Size 6 /Root 1 0 R /Info 3 0 R >>" in table
    assert table.endswith("%%EOF\n")
    assert b"/Type /Catalog /Pages 2 0 R" in data
    assert b"/Type /Pages /Kids [ 4 0 R ] /Count 1" in data
    assert b"/Type /Page /Parent 2 0 R" in data
    assert b"/Contents 5 0 R" in data
    size = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", data)
    assert size is not None
    paper = [float(each) * 25.4 / 72.0 for each in size.groups()]
    assert paper == pytest.approx([sheet.width, sheet.height], abs=1e-3)
    length = re.search(rb"/Length (\d+) /Filter /FlateDecode >>\nstream\n", data)
    assert length is not None
    assert data[length.end() + int(length[1]) :].startswith(b"\nendstream")
