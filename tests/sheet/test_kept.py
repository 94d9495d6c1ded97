"""Whole sheets, mark by mark: views, dimensions, notes, tables, frame and title block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np

import camgeo
from camgeo.design.design import Design
from camgeo.pictures.sheet.marks import Chain, Filled, Hatched, Mark, Sheet
from camgeo.pictures.sheet.sheet import sheets_of
from camgeo.scene.scene import load_scene, parse_scene
from tests import kept
from tests.sheet.sheets import FULL, HUBBED, TOLERANCE, edited

FIXTURES = Path(__file__).parents[2] / "fixtures"

CHAMFERED = HUBBED.replace(
    "keyway = { width = 5, depth = 2.3, angle = 90 }",
    """d_shaft = { across = 14, angle = 20 }
bolt_circle = { count = 4, circle = 50, hole = 4 }
chamfers = { outline = { width = 0.5, edges = "upper" }, bore = { width = 1 } }""",
)


def sheets() -> Iterator[tuple[str, Sequence[Sheet]]]:
    """Of a part with a hub, holes and all that a scene can state; of one in inches in German, with
    a table on a sheet of its own; of one with chamfers and a flat; of a pair in one piece.
    """
    keys = edited(dict(FULL))
    full = load_scene(FIXTURES / "scenes" / "hub_and_holes.toml").with_values(keys)
    yield "hub and holes", sheets_of(Design(full).disc, TOLERANCE)
    keys = edited({**FULL, "sheet": "A4", "language": "de", "step": 5})
    inch = load_scene(FIXTURES / "scenes" / "inch.toml").with_values(keys)
    yield "inches on A4 in German", sheets_of(Design(inch).disc, TOLERANCE)
    chamfered = parse_scene(CHAMFERED).with_values(edited({"step": 0, "motion": False}))
    yield "chamfers and a flat", sheets_of(Design(chamfered).disc, TOLERANCE)
    scene = camgeo.load(FIXTURES / "pairs" / "conjugate_pair.toml").scene
    pair = Design(scene.with_values(edited({"material": "C45"}))).disc.pair
    assert pair is not None
    yield "a pair in one piece", sheets_of(pair, TOLERANCE)


def lines_of(marks: Sequence[Mark]) -> Iterator[str]:
    """Marks, one a line, of chains and polygons those of one kind and layer together."""

    def kind(mark: Mark) -> tuple[str, ...]:
        drawn = isinstance(mark, (Chain, Filled, Hatched))
        return (type(mark).__name__, getattr(mark, "layer", "")) if drawn else ("",)

    for key, group in groupby(sorted(marks, key=kind), kind):
        if key == ("",):
            yield from map(kept.marks, group)
            continue
        every = list(group)
        points = [each.vertices if isinstance(each, Chain) else np.array(each.corners)
                  for each in every if isinstance(each, (Chain, Filled, Hatched))]  # fmt: skip
        sweeps = [each.sweeps for each in every if isinstance(each, Chain)]
        closed = sum(isinstance(each, Chain) and each.closed for each in every)
        yield " ".join((
            *key, f"{len(every)}, closed {closed}", kept.marks(np.concatenate(points)),
            *([kept.marks(np.concatenate(sweeps))] if sweeps else []),
        ))  # fmt: skip


def test_sheets_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name, found in sheets():
            for number, sheet in enumerate(found, 1):
                head = f"{name}, sheet {number}: {sheet.width:g} x {sheet.height:g} mm,"
                yield (
                    f"{head} scale {kept.short(sheet.scale)}, {sheet.unit}, comma {sheet.comma}",
                    "\n".join(lines_of(sheet.marks)),
                )
                for view in sheet.views:
                    yield f"view at {kept.marks(view.at)}", "\n".join(lines_of(view.marks))

    kept.compare("sheet/sheets.txt", parts())
