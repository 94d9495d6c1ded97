"""Material at a cutter: slots, passes, walls beside it, air, in closed form."""

from __future__ import annotations

import pytest

from camgeo.milling.moves import ArcFeed, Feed, Move, Point, Rapid
from camgeo.milling.stages import Run, Setup
from camgeo_export.verify.gcode import Depth, depths
from tests.toolpath.test_simulation import FEED, PLATE, RADIUS


def run(*moves: Move, start: Point = (-60.0, 0.0, 5.0), radius: float = RADIUS) -> Run:
    return Run("cut", moves, radius, start=start)


def along(y: float, z: float) -> tuple[Move, ...]:
    """Through the plate along X, from outside to outside."""
    return Rapid((-60.0, y, 5.0)), Feed((-60.0, y, z), FEED), Feed((60.0, y, z), FEED)


def found(*runs: Run, setup: Setup = PLATE) -> list[Depth]:
    return list(depths(setup, runs))


def worst(*runs: Run) -> tuple[float, float]:
    each = found(*runs)
    return max(d.ahead for d in each), max(d.beside for d in each)


def test_a_slot_and_its_passes() -> None:
    assert worst(run(*along(0.0, -3.0))) == (3.0, 3.0)
    assert worst(run(*along(0.0, -1.0), *along(0.0, -2.5))) == (1.5, 2.5)
    assert worst(run(*along(0.0, -1.0)), run(*along(0.0, -2.5))) == (1.5, 2.5)


def test_along_a_wall_that_is_roughed_nothing_stands_ahead() -> None:
    """The second cut takes 0.3 mm off the side of the first, at full depth."""
    rough, finish = run(*along(0.0, -4.0)), run(*along(0.3, -4.0))
    second = [each for each in found(rough, finish) if each.run == 1]
    assert max(each.ahead for each in second) == 0.0
    assert max(each.beside for each in second) == 4.0


def test_air_is_no_material() -> None:
    assert worst(run(*along(40.0, -4.0))) == (0.0, 0.0)  # beside the plate
    assert worst(run(*along(0.0, 1.0))) == (0.0, 0.0)  # above it
    assert found(run(Feed((0.0, 0.0, -1.0), FEED), start=(0.0, 0.0, 5.0))) == []  # straight down


def test_a_ramp_digs_as_deep_as_it_has_come() -> None:
    down = Feed((20.0, 0.0, -2.0), FEED)
    (middle, end) = found(run(down, start=(-20.0, 0.0, 0.0)))
    assert middle.ahead == pytest.approx(1.0)
    assert end.ahead == pytest.approx(2.0)
    assert end.place == (20.0, 0.0, -2.0)


@pytest.mark.parametrize("ccw", [True, False])
def test_rounds_of_a_slot(ccw: bool) -> None:
    """What the cutter has just cut lies behind it, also on an arc."""

    def round_at(z: float) -> tuple[Move, ...]:
        return tuple(ArcFeed((x, 0.0, z), (0.0, 0.0), ccw, FEED) for x in (-10.0, 10.0))

    down = Feed((10.0, 0.0, -1.5), FEED), Feed((10.0, 0.0, -4.0), FEED)
    both = found(run(down[0], *round_at(-1.5), down[1], *round_at(-4.0), start=(10.0, 0.0, 5.0)))
    # The end of a round looks into its own beginning.
    assert [each.ahead for each in both[:3]] == pytest.approx([1.5] * 3)
    assert max(each.ahead for each in both[4:]) == pytest.approx(2.5)
    assert [each.move for each in both] == [1, 1, 2, 2, 4, 4, 5, 5]
