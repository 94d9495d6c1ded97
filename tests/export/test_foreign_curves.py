"""Curves of other programs that camgeo has no exact form for, and what is wrong in a drawing."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.layouts.layout import Modelspace

from camgeo.errors import FileError
from camgeo.geometry.contour.foreign import Outlines, by_arcs
from camgeo.geometry.contour.spline import SplineContour
from camgeo.reading import PLACED
from camgeo_export.dxf.items import NEAR
from camgeo_export.dxf.reader import READER
from tests.export.test_foreign_contours import drawn
from tests.export.test_shop_drawings import along

FOUND = "fixtures/found/drawings"

ALONG = np.linspace(0.0, 1.0, 100)


def read(draw: Callable[[Modelspace], object]) -> Outlines:
    return READER.read(drawn(draw), "a.dxf", layer=None, unit=None, gap=1e-3)


@pytest.mark.parametrize("ratio", [0.99, 0.5, 0.02])
def test_an_ellipse_is_followed_within_what_is_told(ratio: float) -> None:
    """Distances to first order: x^2/a^2 + y^2/b^2 - 1 over the size of its gradient."""
    a, turn, centre = 60.0, np.exp(0.3j), 7.0 - 5.0j

    def draw(space: Modelspace) -> None:
        major = a * turn
        space.add_ellipse((centre.real, centre.imag), (major.real, major.imag), ratio)

    found = read(draw)
    (contour,) = found.contours
    assert isinstance(contour, SplineContour)
    z = (along(contour) - centre) / turn / a
    value = z.real**2 + (z.imag / ratio) ** 2 - 1.0
    slope = 2.0 * np.hypot(z.real, z.imag / ratio**2)
    off = a * np.max(np.abs(value) / slope)
    assert 1e-3 * NEAR < off <= NEAR + 2e-9
    assert contour.area == pytest.approx(math.pi * a * a * ratio, rel=1e-8)
    assert found.notes == ("a.dxf: 1 ELLIPSE followed by cubics within 1e-07 mm",)


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("seed", range(3))
def test_rational_splines_are_followed_within_what_is_told(degree: int, seed: int) -> None:
    """Points of them by ezdxf are as near to what is read, seen at their nearest."""
    make = random.Random(f"{degree} {seed}")
    count = 3 * degree
    ring = [
        (make.uniform(20, 40) * math.cos(t), make.uniform(20, 40) * math.sin(t))
        for t in np.arange(count) * 2.0 * math.pi / count
    ]
    weights = [make.uniform(0.5, 3.0) for _ in range(count + 1)]

    def draw(space: Modelspace) -> None:
        space.add_rational_spline([*ring, ring[0]], weights, degree=degree)

    found = read(draw)
    (contour,) = found.contours
    assert found.followed == NEAR
    document = ezdxf.new()  # type: ignore[attr-defined]  # not declared
    draw(document.modelspace())
    curve = document.modelspace()[0].construction_tool()
    exact = [complex(each.x, each.y) for each in curve.points(ALONG * curve.max_t)]
    assert isinstance(contour, SplineContour)
    outline = by_arcs(contour, 1e-9)
    starts, ends, centres = outline.vertices, outline.ends, outline.centres
    bent = outline.sweeps != 0.0
    for place in exact:
        arm = place - centres
        across = np.abs(np.abs(arm) - outline.radii)
        inside = (arm / (starts - centres)) ** np.sign(outline.sweeps)
        own = (
            bent & (np.angle(inside) >= -1e-9) & (np.angle(inside) <= np.abs(outline.sweeps) + 1e-9)
        )
        near = np.concatenate((across[own], np.abs(place - starts), np.abs(place - ends)))
        assert np.min(near) <= NEAR + 1e-8


def test_what_lies_on_what_is_told_for_lines_of_any_drawing() -> None:
    """Random polygons with random lines: what touches a corner, ends loosely or divides is left."""
    for seed in range(20):
        make = random.Random(seed)
        count = make.randint(3, 12)
        corners = [
            (make.uniform(30, 60) * math.cos(t), make.uniform(30, 60) * math.sin(t))
            for t in np.sort([make.uniform(0, 2 * math.pi) for _ in range(count)]).tolist()
        ]
        corners = [(x * 1.0, y * 1.0) for x, y in corners]
        sides = list(pairwise([*corners, corners[0]]))
        extra = []
        for _ in range(make.randint(0, 5)):
            corner = make.choice(corners)
            away = (make.uniform(70, 99), make.uniform(70, 99))
            extra.append((corner, away))
        doubles = [side[::-1] for side in sides if make.random() < 0.3]
        every = sides + extra + doubles
        make.shuffle(every)

        def draw(space: Modelspace, every: Any = every) -> None:
            for start, end in every:
                space.add_line(start, end)

        found = read(draw)
        (contour,) = found.contours
        area = 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in sides)
        assert contour.area == pytest.approx(abs(area), rel=1e-12)
        told = sum(int(note.split(": ")[1].split()[0]) for note in found.notes)
        assert told == len(extra) + len(doubles)


def test_blocks_without_end_are_refused() -> None:
    def itself(space: Modelspace) -> None:
        inner = space.doc.blocks.new("A")
        inner.add_circle((0, 0), 1.0)
        inner.add_blockref("a", (5, 0))
        space.add_blockref("A", (0, 0))

    found = read(itself)
    assert len(found.contours) == 1
    assert "inserts a block into itself" in found.notes[0]

    def many(space: Modelspace) -> None:
        for k in range(6):
            block = space.doc.blocks.new(f"B{k}")
            for x in range(10):
                block.add_blockref(f"B{k + 1}", (x, 0))
        space.doc.blocks.new("B6")
        space.add_blockref("B0", (0, 0))

    with pytest.raises(FileError, match=rf"in blocks; at most {PLACED:,} are allowed"):
        read(many)


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda space: None, "no contour found; supported: LINE, ARC"),
        (lambda space: space.add_text("A"), "no contour found; not read: 1 TEXT"),
        (
            lambda space: space.add_circle((0, 0), 5.0, dxfattribs={"layer": "DEFPOINTS"}),
            "no contour found; 1 entity not read that the drawing does not show",
        ),
        (lambda space: space.add_line((0, 0), (1, 0)), r"LINE has a loose end at \(0, 0\) mm"),
        (lambda space: space.add_mesh() and None, "no contour found"),
    ],
)
def test_a_drawing_without_a_contour_is_refused_with_the_reason(
    draw: Callable[[Modelspace], object], message: str
) -> None:
    with pytest.raises(FileError, match=message):
        read(draw)


def test_a_line_end_is_any() -> None:
    data = drawn(lambda space: space.add_circle((1, 2), 3.0))
    for end in (b"\r\n", b"\r"):
        found = READER.read(
            b"\xef\xbb\xbf" + data.replace(b"\n", end), "a.dxf", layer=None, unit=None, gap=0.0
        )
        assert found.contours[0].area == pytest.approx(9.0 * math.pi, rel=1e-12)


def test_the_centre_of_the_bore_is_found_among_others() -> None:
    """That of a bore with a keyway, as one of arcs and lines; not that of a bolt hole."""
    middle = 100.0 + 50.0j

    def draw(space: Modelspace) -> None:
        space.add_circle((90, 50), 40.0)
        for x in (70, 130):
            space.add_circle((x, 50), 3.0)
        half = math.asin(0.3)
        points = [(middle + 10.0 * np.exp(1j * t)) for t in (half, -half)]
        bulge = math.tan(0.25 * (2.0 * math.pi - 2.0 * half))
        corners = [(points[0].real, points[0].imag, bulge), (points[1].real, points[1].imag, 0.0),
                   (112.0, points[1].imag, 0.0), (112.0, points[0].imag, 0.0)]  # fmt: skip
        space.add_lwpolyline(corners, format="xyb", close=True)

    found = read(draw)
    outline = found.contours[0]
    assert not isinstance(outline, SplineContour)
    assert found.off_axis(outline) == "its bore is about (100, 50) mm: --origin 100 50"
    moved = found.about(middle)
    assert moved.contours[1].area == pytest.approx(found.contours[1].area, rel=1e-12)
    outline = moved.contours[0]
    assert not isinstance(outline, SplineContour)
    assert moved.off_axis(outline) == ""
