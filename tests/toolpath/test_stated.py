"""Operations that a scene states: each makes its cut, or says why its tool cannot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import distances
from camgeo.milling.cut import AreaCut, ContourCut, Cut, slack_of
from camgeo.milling.milling import OperationSpec, Stock
from camgeo.milling.moves import ArcFeed
from camgeo.milling.strategies import moves_of
from camgeo.milling.track import Track
from camgeo.part.spec import Keyway
from tests.toolpath.milled import (
    BORE,
    FIXTURE,
    HEIGHTS,
    MILL,
    POINTED,
    ROLLER,
    SLOTTER,
    SPEC,
    THICKNESS,
    TOOLS,
    named,
    operation,
    part,
    sequence,
    tool,
)

INNER, GROOVE = Contact.INNER, Contact.GROOVE

ROUND = Stock(shape="round", diameter=170.0, top=1.0)

BOTTOM = -THICKNESS - FIXTURE.through


def cuts(
    *operations: OperationSpec, contact: Contact = INNER, stock: Stock = ROUND
) -> dict[str, Cut]:
    return named(sequence(contact, *TOOLS, stock=stock, operations=operations))


def test_a_wall_that_nothing_has_roughed_is_finished_in_passes() -> None:
    finish = cuts(operation("finish", "outline"), stock=Stock())["outline"]
    assert isinstance(finish, ContourCut)
    assert (finish.strategy, finish.cleared, len(finish.depths)) == ("slot", False, 4)
    roughed = cuts(operation("rough", "outline"), operation("finish", "outline"), stock=Stock())[
        "outline"
    ]
    assert len(roughed.depths) == 1


@pytest.mark.parametrize(
    ("boundary", "contact"),
    [
        ("outline", INNER), ("bore", INNER), ("bore", GROOVE), ("rim", GROOVE),
        ("inner flank", GROOVE), ("outer flank", GROOVE),
    ],
)  # fmt: skip
def test_the_chamfer_is_as_wide_as_stated(boundary: str, contact: Contact) -> None:
    """The cone meets the upper face at the size from the wall, and the wall as far below it; its
    feed is held there.
    """
    size, own = 0.5, POINTED.feed
    cut = cuts(operation("chamfer", boundary, 3, size=size), contact=contact, stock=Stock())[
        f"chamfer {boundary}"
    ]
    assert isinstance(cut, ContourCut)
    reach = -cut.bottom * math.tan(0.5 * 0.5 * math.pi)  # radius of the cone at the upper face
    beside = reach - size  # from the wall to the cutter's centre
    assert beside > 0.0
    assert cut.contact == pytest.approx(reach)
    (wall,) = (each for each in part(contact).boundaries if each.name == boundary)
    path = cut.centre.arcs(1e-4, "fast").contour
    ring = wall.arcs(1e-4, "fast").contour
    apart = distances(path.vertices, Track.around(ring))
    assert apart == pytest.approx(np.full(len(path), beside), abs=2.1e-4)
    moves = moves_of(cut, HEIGHTS, 0.001, "fast")
    arcs = [
        (abs(complex(*each.end[:2]) - complex(*each.centre)), each.feed)
        for each in moves
        if isinstance(each, ArcFeed)
    ]
    assert min(feed for _, feed in arcs) >= own * min(r / (r + reach) for r, _ in arcs) * 0.999
    assert cut.note == "0.5 mm wide on the face"


def test_the_edge_of_a_bore_with_a_keyway_is_round() -> None:
    keyed = replace(SPEC, keyway=Keyway(8.0, 3.3))
    made = operation("chamfer", "bore", 3, size=0.5)
    (cut,) = sequence(GROOVE, *TOOLS, operations=(made,), spec=keyed).cuts
    assert isinstance(cut, ContourCut)
    assert cut.centre.arcs(0.01).contour.radii == pytest.approx(0.5 * BORE - 0.05)


@pytest.mark.parametrize(
    ("finish", "cleared", "room"),
    [(MILL.number, True, 0.3), (7, True, 2.3), (SLOTTER.number, False, 0.0)],
)
def test_leads_stay_in_the_slot_that_roughing_has_made(
    finish: int, cleared: bool, room: float
) -> None:
    """It begins at its own allowance and is as wide as its cutter; a wider one enters along it."""
    small = tool(10.0, 7)
    made = sequence(
        INNER, *TOOLS, small,
        operations=(
            operation("rough", "outline", allowance=0.3), operation("finish", "outline", finish)
        ),
    )  # fmt: skip
    cut = named(made)["outline"]
    assert isinstance(cut, ContourCut)
    assert cut.cleared == cleared
    slack = slack_of(0.3) if cleared else 0.0  # by which the slot runs farther off
    assert cut.room == pytest.approx(room + slack)
    assert cut.rest == (0.3 if cleared else 0.0)


def test_the_strategy_of_a_slot_may_be_stated() -> None:
    ramp = cuts(operation("face"), operation("rough", "outline", strategy="ramp"))["rough outline"]
    assert isinstance(ramp, ContourCut)  # though the blank is round
    assert ramp.strategy == "slot"


def test_loops_clear_a_groove_at_once_where_they_are_small_enough() -> None:
    def loops(diameter: float) -> AreaCut:
        rough = operation("rough", "outer flank", allowance=0.2, strategy="trochoidal")
        (cut,) = sequence(GROOVE, tool(diameter), stock=Stock(), operations=(rough,)).cuts
        assert isinstance(cut, AreaCut)
        return cut

    assert [wall.name for wall in loops(10.0).walls] == ["outer flank", "inner flank"]
    assert loops(10.0).slot == pytest.approx(2.0 * (ROLLER - 0.2))
    assert [wall.name for wall in loops(6.0).walls] == ["outer flank"]


@pytest.mark.parametrize("stock", [Stock(), ROUND])
def test_both_flanks_of_a_groove_are_roughed_and_finished_with_leads(stock: Stock) -> None:
    """Whatever the blank: the inner flank bounds an island, around which nothing is cleared."""
    walls = ("outer flank", "inner flank")
    found = cuts(
        *(operation("rough", wall, allowance=0.2) for wall in walls),
        *(operation("finish", wall) for wall in walls),
        contact=GROOVE, stock=stock,
    )  # fmt: skip
    for wall in walls:
        rough, finish = found[f"rough {wall}"], found[wall]
        assert isinstance(rough, ContourCut)
        assert isinstance(finish, ContourCut)
        assert finish.cleared
        assert finish.room == pytest.approx(0.5 * (ROLLER - MILL.radius))
