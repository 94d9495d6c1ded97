"""Random changes of the product: what is changed, which tests are asked, and the verdicts."""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import mutants
from tests.mutants import Mutant, drawn, modules_for, name_of, places, room_of, verdict

SOURCE = '''"""A text with 1 number."""

from __future__ import annotations

import math


@decorated(2)
def area(side: tuple[float, 3], radius: float = 4.0) -> Tagged[float, 5]:
    """Text."""
    if TYPE_CHECKING:
        import numpy
    if radius < 0 and not side:
        raise ValueError(f"{radius + 7}")
    total: Counted[8] = -radius
    total += side[0] * area(radius, total)
    record(total)
    return max(total, radius)
'''

CHANGES = {
    "constant: 4.0 -> 5.0",
    "constant: 4.0 -> 8.0",
    "condition: if radius < 0 and (not side): -> if not (radius < 0 and (not side)):",
    "and, or: radius < 0 and (not side) -> radius < 0 or not side",
    "comparison: radius < 0 -> radius <= 0",
    "comparison: radius < 0 -> radius >= 0",
    "constant: 0 -> 1",
    "not: not side -> side",
    "dropped: raise ValueError(f'{radius + 7}') -> pass",
    "sign: -radius -> radius",
    "arithmetic: total += side[0] * area(radius, total) -> total -= side[0] * area(radius, total)",
    "dropped: total += side[0] * area(radius, total) -> pass",
    "arithmetic: side[0] * area(radius, total) -> side[0] / area(radius, total)",
    "index: side[0] -> side[1]",
    "arguments: area(radius, total) -> area(total, radius)",
    "dropped: record(total) -> pass",
}
"""Of `SOURCE`: nothing in texts, annotations, decorators, imports, or where types are checked."""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "area.py"
    path.write_text(SOURCE, "utf-8")
    monkeypatch.setattr(mutants, "ROOT", tmp_path)
    return path


def every(path: Path) -> Iterator[Mutant]:
    for statement in places(path):
        for each in statement:
            yield mutants.mutant(path, *each)


def test_the_changes_of_a_module(module: Path) -> None:
    found = [each.text for each in every(module)]
    assert len(set(found)) == len(found) - 1  # the 0 of the comparison and that of the index
    assert set(found) == CHANGES


def test_each_change_is_made_alone_and_where_it_is_said(module: Path) -> None:
    whole = ast.unparse(ast.parse(SOURCE)).splitlines()
    for each in every(module):
        differing = [
            (before.strip(), after.strip())
            for before, after in zip(whole, each.source.splitlines(), strict=True)
            if before != after
        ]
        assert len(differing) == 1, each.text
        before, after = each.text.partition(": ")[2].split(" -> ")
        assert before in differing[0][0]
        assert after in differing[0][1]
        assert any(
            before in ast.unparse(node)
            for node in ast.walk(ast.parse(SOURCE))
            if isinstance(node, ast.stmt) and node.lineno == each.line
        )


def test_a_seed_draws_the_same_each_of_another_statement(module: Path) -> None:
    first, second, third = (drawn([module], 5, random.Random(seed)) for seed in (1, 1, 2))
    assert first == second != third
    assert len({each.line for each in first}) == 5


def test_a_module_is_of_the_room_of_the_longest_folder() -> None:
    assert room_of(mutants.ROOT / "camgeo/numeric/arrays.py") == "numeric"
    assert room_of(mutants.ROOT / "camgeo/dynamics/oscillator/steady.py") == "dynamics"
    assert room_of(mutants.ROOT / "export/camgeo_export/dxf/writer.py") == "export"
    assert room_of(mutants.ROOT / "camgeo/units.py") is None


def test_all_rooms_are_there() -> None:
    folders = [folder for each in mutants.ROOMS.values() for folder in each]
    assert [each for each in folders if not (mutants.ROOT / each).exists()] == []


def test_names_of_modules() -> None:
    assert name_of("camgeo/check/judge.py") == "camgeo.check.judge"
    assert name_of("camgeo/check/__init__.py") == "camgeo.check"
    assert name_of("export/camgeo_export/dxf/writer.py") == "camgeo_export.dxf.writer"


@pytest.mark.long  # reads all modules, as the tool does there
def test_the_mirror_folder_is_asked_first_and_direct_importers_follow() -> None:
    modules = modules_for("camgeo/geometry/pieces.py")
    inside = [each.startswith("tests/outline/") for each in modules]
    assert any(inside)
    assert inside == sorted(inside, reverse=True)
    importing = [
        "from camgeo.geometry.pieces" in (mutants.ROOT / each).read_text("utf-8")
        for each in modules
    ]
    own = [each for each, near in zip(importing, inside, strict=True) if near]
    assert any(own)
    assert own == sorted(own, reverse=True)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("def two():\n    return 3\n", "caught"),
        ("def two():\n    return 2.0\n", "survived"),
        ("def two():\n    while True: pass\n", "timed out"),
    ],
)
def test_verdicts(
    changed: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = "def two():\n    return 2\n"
    (tmp_path / "product.py").write_text(original, "utf-8")
    (tmp_path / "test_of_it.py").write_text(
        "from product import two\n\ndef test_it():\n    assert two() == 2\n", "utf-8"
    )
    (tmp_path / "conftest.py").write_text(
        "from hypothesis import settings\nsettings.register_profile('first')\n", "utf-8"
    )
    monkeypatch.setattr(mutants, "modules_for", lambda _: ["test_of_it.py"])
    monkeypatch.setattr(mutants, "CPU", 2 if expected == "timed out" else 10)
    assert verdict(tmp_path, Mutant("product.py", 2, "", changed), 1) == expected
    assert (tmp_path / "product.py").read_text("utf-8") == original
