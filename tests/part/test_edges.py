"""Which edges of a part go through the disc, and how deep the others are."""

from __future__ import annotations

import pytest

from camgeo.part.part import Edge, Layer, Part, edges_of
from camgeo_export.reading import layer_name, of_the_part
from tests.effects.scenes import design
from tests.part.parts import circle


def test_edges_of_hubs_pockets_and_holes() -> None:
    rim, bore = circle("rim", 40.0), circle("bore", 6.0, hole=True)
    upper, lower = circle("hub", 12.0), circle("lower hub", 15.0)
    pocket, recess = (circle(name, 5.0, 27j, hole=True) for name in ("pocket", "recess"))
    part = Part(
        (
            Layer(-19.0, -12.0, (lower, bore), "lower hub"),
            Layer(-12.0, -9.5, (rim, recess, bore)),
            Layer(-9.5, -6.25, (rim, bore)),
            Layer(-6.25, 0.0, (rim, pocket, bore)),
            Layer(0.0, 8.0, (upper, bore), "hub"),
        )
    )
    found = {each.boundary.name: each for each in edges_of(part)}
    assert list(found) == [each.name for each in part.boundaries]
    names = {name: layer_name(edge, 1.0) for name, edge in found.items()}
    assert names == {
        "rim": "CUT",
        "bore": "CUT",
        "pocket": "BLIND_6.25",
        "recess": "BLIND_BELOW_2.5",
        "hub": "RAISED_8",
        "lower hub": "RAISED_BELOW_7",
    }
    assert layer_name(found["pocket"], 25.4) == "BLIND_0.246063"
    assert of_the_part(["0", *names.values(), "BLIND", "BLINDS", "PITCH_CURVE"]) == {
        *names.values(),
        "BLIND",
    }


@pytest.mark.parametrize(("change", "name"), [
    (("groove_depth = 10", ""), "BLIND"),
    (("groove_depth = 10", "groove_depth = 0.1"), "BLIND_0.1"),
])  # fmt: skip
def test_flanks_of_a_groove_are_blind_with_or_without_a_depth(
    change: tuple[str, str], name: str
) -> None:
    formats = ('formats = ["dxf", "gcode", "stl", "3mf", "csv", "svg", "png"]', 'formats = ["dxf"]')
    part = design("groove", "", change, formats).disc.drawn.part
    kinds = {each.boundary.name: layer_name(each, 1.0) for each in edges_of(part)}
    assert kinds == {"rim": "CUT", "bore": "CUT", "inner flank": name, "outer flank": name}


def test_a_depth_is_written_without_an_exponent() -> None:
    edge = Edge(circle("mark", 1.0, hole=True), "sunk", by=1e-5)
    assert layer_name(edge, 1.0) == "BLIND_0.00001"
    assert layer_name(Edge(edge.boundary, "sunk", by=12345.0), 1.0) == "BLIND_12345"
    assert layer_name(Edge(edge.boundary, "sunk", by=0.1 + 0.2), 1.0) == "BLIND_0.3"


def test_a_hole_below_a_counterbore_is_cut_through() -> None:
    rim, hole, wide = (
        circle("rim", 40.0),
        *(circle(name, radius, 20j, hole=True) for name, radius in (("hole", 3.0), ("wide", 5.0))),
    )
    beside = circle("beside", 3.0, -20j, hole=True)
    part = Part((Layer(-9.0, -4.0, (rim, hole, beside)), Layer(-4.0, 0.0, (rim, wide))))
    assert {each.boundary.name: layer_name(each, 1.0) for each in edges_of(part)} == {
        "rim": "CUT", "hole": "CUT", "beside": "BLIND_BELOW_5", "wide": "BLIND_4",
    }  # fmt: skip
