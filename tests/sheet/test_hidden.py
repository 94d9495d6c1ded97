"""Edges of which a part is hidden: of a pair in one piece, seen from above."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

import camgeo
from camgeo.design.product import Product
from camgeo.pictures.sheet.front import chains_of
from camgeo.pictures.sheet.marks import Chain
from camgeo.pictures.sheet.shape import Edge, Shape, shape_of

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
