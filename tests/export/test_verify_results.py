"""Small damages to files of each format: which are told, by which checks, where, and by how much.

fixtures/results/damages.json has all of it, as it was found and looked at before.
"""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import pytest

from tests.export.damages import FILE, FILES, HARMLESS, PROGRAMS, document, said, written
from tests.toolpath import programs
from tests.toolpath.test_programs import same


@cache
def kept() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text("utf-8"))
    return found


def require_kept(name: str) -> None:
    """That all is said that was said before, and that the good file passes."""
    found = json.loads(json.dumps(document(name)))
    assert found.keys() == kept()[name].keys()
    assert not list(same(found, kept()[name], name))
    assert all(each["ok"] is not False for each in found[""]["other"])
    told = [
        row for what, row in found.items() if any(not each.get("ok", 1) for each in row["other"])
    ]
    assert 2 * len(told) > len(found)


@pytest.mark.parametrize("name", [name for name in FILES if name.startswith("dxf")])
def test_drawings(name: str) -> None:
    require_kept(name)


def test_a_drawing_for_a_laser() -> None:
    require_kept("svg")


@pytest.mark.parametrize("name", [name for name in FILES if name.startswith("step")])
def test_solids(name: str) -> None:
    require_kept(name)


@pytest.mark.parametrize("name", ["3mf", "stl"])
def test_meshes(name: str) -> None:
    require_kept(name)


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs(name: str) -> None:
    require_kept(name)


@pytest.mark.parametrize("name", ["stated, conventional", "planned, a groove in one round"])
@pytest.mark.parametrize("what", HARMLESS)
def test_what_changes_nothing_is_no_damage(name: str, what: str) -> None:
    """Other spellings of the same program: no check says anything else, but for lines."""
    text = written("gcode", programs.SCENES[name]).decode()
    after = HARMLESS[what](text)
    assert after != text
    good, other = (
        [{**each, "note": ""} for each in said(name, data.encode())] for data in (text, after)
    )
    assert not list(same(json.loads(json.dumps(other)), json.loads(json.dumps(good)), what))


def test_all_kinds_of_files_are_there() -> None:
    assert kept().keys() == FILES.keys()
    kinds = {kind for kind, _, _ in FILES.values()}
    assert kinds == {"dxf", "svg", "step", "3mf", "stl", "gcode"}
