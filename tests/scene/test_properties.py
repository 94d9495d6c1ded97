"""What holds for any scene: it loads, or SceneError states why not."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import SceneError
from camgeo.scene.scene import parse_scene
from tests.scene.scenes import PLATE, loaded


@given(st.text(max_size=200))
def test_any_text_raises_scene_error(text: str) -> None:
    with pytest.raises(SceneError):
        parse_scene(text)


@given(st.permutations(PLATE.split("\n[")[1:]))
def test_order_of_the_tables_does_not_matter(tables: list[str]) -> None:
    head = PLATE.split("\n[")[0]
    # The segments stay in their order, and a table is defined after the array it is not part of.
    segments = [table for table in PLATE.split("\n[")[1:] if table.startswith("[motion]")]
    others = [table for table in tables if not table.startswith("[motion]")]
    scene = parse_scene("\n[".join([head, *others[:3], *segments, *others[3:]]))
    original = loaded(PLATE)
    assert [s.span for s in scene.plan.segments] == [s.span for s in original.plan.segments]
    for name in ("name", "unit", "rotation", "speed", "follower", "limits", "part", "output"):
        assert getattr(scene, name) == getattr(original, name)


LENGTHS = st.decimals(min_value=Decimal("0.01"), max_value=100, places=4)


@given(LENGTHS, LENGTHS, LENGTHS, LENGTHS)
def test_inches_are_millimetres_scaled(
    base: Decimal, roller: Decimal, stroke: Decimal, thickness: Decimal
) -> None:
    def scene(unit: str, factor: Decimal) -> str:
        return f"""
camgeo = 1
name = "x"
units.length = "{unit}"
cam.rotation = "cw"
follower = {{ kind = "translating-roller", base_radius = {base * factor}, offset = 0.0,
              roller_radius = {roller * factor} }}
part.thickness = {thickness * factor}
output.tolerance = {Decimal("0.0000254") * factor}
motion = [
  {{ law = "simple-sine", span = 180, to = {stroke * factor} }},
  {{ law = "simple-sine", span = 180, to = 0 }},
]
""".replace("0.0,\n", "0.0,")

    def lengths(found: Any) -> list[float]:
        follower, tolerance = found.follower, found.output.tolerance
        radii = (follower.base_radius, follower.roller_radius)
        return [*radii, found.part.thickness, tolerance, found.plan.segments[0].to]

    inch = lengths(parse_scene(scene("inch", Decimal(1))))
    assert inch == pytest.approx(lengths(parse_scene(scene("mm", Decimal("25.4")))), rel=1e-15)


@given(st.lists(st.decimals(min_value=Decimal("0.001"), max_value=30, places=6), max_size=11))
def test_spans_add_up_exactly_or_not_at_all(spans: list[Decimal]) -> None:
    spans = [*spans, 360 - sum(spans, Decimal(0))]
    head = PLATE.partition("[[motion]]")[0]
    motion = "".join(f"[[motion]]\ndwell = {span}\n" for span in spans)
    assert len(parse_scene(head + motion).plan.segments) == len(spans)
    short = motion.replace(f"= {spans[-1]}\n", f"= {spans[-1] - Decimal('1e-20')}\n")
    if short.count(str(spans[-1])) == 0:
        with pytest.raises(SceneError, match=r"359\.99999999999999999999 degrees"):
            parse_scene(head + short)
