"""The front view: dashes of curves and lines, and the edges of which a part is hidden."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

import camgeo
from camgeo.design.product import Product
from camgeo.geometry.contour.contour import Contour
from camgeo.pictures.sheet.front import (
    DASH_DOT,
    DASH_DOTS,
    chains_of,
    dashed,
    dashed_stretch,
    in_dashes,
)
from camgeo.pictures.sheet.marks import Chain, Label, Mark, line
from camgeo.pictures.sheet.shape import Edge, Shape, shape_of


def length(chain: Chain) -> float:
    """Of a chain [mm]."""
    chord = np.abs(np.diff(chain.vertices))
    half = 0.5 * np.abs(chain.sweeps[:-1])
    return float(np.sum(chord * np.where(half == 0.0, 1.0, half / np.sin(np.where(half, half, 1)))))


@pytest.mark.parametrize("pattern", [DASH_DOT, DASH_DOTS])
@pytest.mark.parametrize("scale", [0.01, 1.0, 50.0])
def test_dashes_lie_on_the_curve_in_their_proportion(
    pattern: tuple[float, ...], scale: float
) -> None:
    """A whole number of patterns, in pieces of any length: a circle of many arcs."""
    radius = 20.0 / scale
    circle = Contour.circle(radius).split(0.01)
    found = list(dashed(circle, scale, "PITCH_CURVE", pattern))
    assert len(found) % (len(pattern) / 2) == 0
    share = sum(pattern[::2]) / sum(pattern)
    assert sum(map(length, found)) == pytest.approx(share * circle.length, rel=1e-9)
    for each in found:
        assert np.allclose(np.abs(each.vertices), radius, rtol=1e-12)


def test_a_line_begins_and_ends_with_a_dash() -> None:
    whole = line(1 + 1j, 1 + 101j, "CENTRE")
    found = [each for each in in_dashes([whole], 1.0) if isinstance(each, Chain)]
    assert found[0].vertices[0] == 1 + 1j
    assert found[-1].vertices[1] == pytest.approx(1 + 101j)
    assert length(found[0]) == pytest.approx(length(found[-1]))
    assert all(each.layer == "CENTRE" for each in found)


def test_short_lines_and_other_layers_stay_as_they_are() -> None:
    marks: list[Mark] = [line(0j, 5 + 0j, "CENTRE"), line(0j, 500 + 0j, "OUTLINE"), Label("A", 0j)]
    assert list(in_dashes(marks, 1.0)) == marks


@pytest.mark.parametrize("sweep", [0.0, 0.3, -2.0])
def test_a_stretch_begins_and_ends_with_a_dash(sweep: float) -> None:
    """Of lines and arcs: its ends are those of the outer dashes, and the gaps are between."""
    whole = Chain(np.array([0j, 30 + 0j, 60 + 10j]), np.array([0.0, sweep, 0.0]), "HIDDEN")
    found = list(dashed_stretch(whole, 1.0, (4.2, 1.05)))
    assert found[0].vertices[0] == 0j
    assert found[-1].vertices[-1] == pytest.approx(60 + 10j)
    share = sum(map(length, found)) / length(whole)
    assert share == pytest.approx(4.2 / 5.25, abs=0.02)
    short = Chain(np.array([0j, 3 + 0j]), np.zeros(2), "HIDDEN")
    assert list(dashed_stretch(short, 1.0, (4.2, 1.05))) == [short]


PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"

TOLERANCE = 0.01


@cache
def pair_with(upper: str = "main") -> Product:
    scene = camgeo.load(PAIR).scene.with_values({"part.pair.upper": upper, "output.fit": "fast"})
    found = camgeo.Design(scene).disc.pair
    assert found is not None
    return found


def edge_of(shape: Shape, name: str) -> Edge:
    return next(each for each in shape.edges if each.boundary.name == name)


def middles_of(chain: Chain) -> list[complex]:
    """Of its lines and arcs."""
    start, end = chain.vertices[:-1], chain.vertices[1:]
    found: list[complex] = (
        0.5 * (start + end) - 0.5j * (end - start) * np.tan(0.25 * chain.sweeps[:-1])
    ).tolist()
    return found


@pytest.mark.parametrize(("upper", "above", "below"), [
    ("main", "outline", "return outline"), ("return", "return outline", "outline"),
])  # fmt: skip
def test_the_lower_outline_is_dashed_where_the_upper_disc_lies_over_it(
    upper: str, above: str, below: str
) -> None:
    shape = shape_of(pair_with(upper).drawn.part, TOLERANCE, "fast")
    over, under = (edge_of(shape, name) for name in (above, below))
    assert [each.layer for each in chains_of(shape, over)] == ["OUTLINE"]
    chains = chains_of(shape, under)
    layers = [each.layer for each in chains]
    assert set(layers) == {"OUTLINE", "HIDDEN"}
    assert all(one != other for one, other in zip(layers, [*layers[1:], layers[0]], strict=True))
    ends = over.contour.points(1e-5)
    disc = shapely.Polygon(np.column_stack((ends.real, ends.imag)))
    for chain, after in zip(chains, [*chains[1:], chains[0]], strict=True):
        assert abs(chain.vertices[-1] - after.vertices[0]) < 1e-6
        near = 1e-4 * shape.size
        for point in middles_of(chain):
            inside = disc.contains(shapely.Point(point.real, point.imag))
            away = disc.exterior.distance(shapely.Point(point.real, point.imag))
            assert inside == (chain.layer == "HIDDEN") or away <= 10.0 * near
    whole = float(np.sum(under.contour.lengths))
    lengths = [
        # np.sinc(x) is sin(pi x) / (pi x): an arc is longer than its chord by that
        np.abs(np.diff(each.vertices)) / np.sinc(0.5 * each.sweeps[:-1] / np.pi)
        for each in chains
    ]
    assert float(np.sum(np.concatenate(lengths))) == pytest.approx(whole, rel=1e-9)


def test_hub_and_spacer_are_hidden_as_a_whole() -> None:
    shape = shape_of(pair_with().drawn.part, TOLERANCE, "fast")
    for name in ("spacer", "lower hub"):
        (chain,) = chains_of(shape, edge_of(shape, name))
        assert chain.closed
        assert chain.layer == "HIDDEN"
