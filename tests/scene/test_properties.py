"""What holds for any scene: it loads, or SceneError states why not."""

from __future__ import annotations

import contextlib
import copy
import json
import math
import tomllib
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import SceneError
from camgeo.scene.scene import load_scene, parse_scene
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, PLATE, ROCKER, loaded

SCENES = [tomllib.loads(text) for text in (PLATE, ROCKER, LINKED, GROOVE)]

NAMES = st.sampled_from(
    [
        "kind",
        "span",
        "dwell",
        "to",
        "law",
        "base_radius",
        "bore",
        "rim",
        "camgeo",
        "a b",
        "\u00e4",
        "",
    ]
)

LEAVES = st.one_of(
    st.none(),  # the key is taken out
    st.booleans(),
    st.integers(min_value=-(2**70), max_value=2**70),
    st.integers(min_value=-3, max_value=400),
    st.floats(),
    st.floats(min_value=-400, max_value=400),
    st.text(max_size=8),
    st.sampled_from(["cw", "ccw", "groove", "outer", "inward", "inch", "auto", "gcode"]),
)

VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(NAMES, inner, max_size=3)),
    max_leaves=4,
)


def toml(value: Any) -> str:
    """A value as inline TOML."""
    if isinstance(value, dict):
        pairs = (f"{json.dumps(k)} = {toml(v)}" for k, v in value.items() if v is not None)
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(item) for item in value if item is not None) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return json.dumps(value)


def toml_file(scene: dict[str, Any]) -> str:
    return "".join(f"{key} = {toml(item)}\n" for key, item in scene.items() if item is not None)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene["name"])
def test_unspoilt_scenes_load(scene: dict[str, Any]) -> None:
    parse_scene(toml_file(scene))


@given(st.sampled_from(SCENES), st.data())
def test_any_mutation_loads_or_raises_scene_error(scene: dict[str, Any], data: Any) -> None:
    scene = copy.deepcopy(scene)
    for _ in range(data.draw(st.integers(1, 3))):
        table: Any = scene
        while True:
            keys = list(table) if isinstance(table, dict) else list(range(len(table)))
            key = data.draw(st.sampled_from(keys)) if keys else None
            if key is None or not isinstance(table[key], dict | list) or data.draw(st.booleans()):
                break
            table = table[key]
        if isinstance(table, dict) and (key is None or data.draw(st.booleans())):
            key = data.draw(NAMES)
        if key is not None:
            table[key] = data.draw(VALUES)
    with contextlib.suppress(SceneError):
        parse_scene(toml_file(scene))


@given(st.text(max_size=200))
def test_any_text_raises_scene_error(text: str) -> None:
    with pytest.raises(SceneError):
        parse_scene(text)


@given(st.binary(max_size=20), st.integers(0, len(PLATE) - 1), st.integers(0, 20))
def test_any_edit_loads_or_raises_scene_error(new: bytes, place: int, length: int) -> None:
    text = (PLATE[:place].encode() + new + PLATE[place + length :].encode()).decode("latin-1")
    with contextlib.suppress(SceneError):
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


@pytest.mark.parametrize("file", sorted(FIXTURES.glob("*.toml")), ids=lambda file: file.stem)
def test_fixtures_load(file: Any) -> None:
    scene = load_scene(file)
    assert scene.name == file.stem
    assert set(scene.output.formats) == {"dxf", "gcode", "stl", "3mf", "csv", "svg", "png"}
