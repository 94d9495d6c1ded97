"""Small damages to files of each format: which are told, by which checks, where, and by how much.

All of it is kept, as it was found and looked at before.
"""

from __future__ import annotations

import pytest

from tests import kept
from tests.export.damages import FILES, HARMLESS, PROGRAMS, document, said, written
from tests.toolpath import programs


def require_kept(name: str) -> None:
    """That all is said that was said before, and that the good file passes."""
    found = document(name)
    kept.compare_documents(f"export/damages/{name}", found)
    assert all(each["ok"] is not False for each in found[""]["other"])
    told = [
        row for what, row in found.items() if any(not each.get("ok", 1) for each in row["other"])
    ]
    assert 2 * len(told) > len(found)


@pytest.mark.parametrize("name", [name for name in FILES if name.startswith("dxf")])
def test_drawings_are_as_kept(name: str) -> None:
    require_kept(name)


def test_a_drawing_for_a_laser_is_as_kept() -> None:
    require_kept("svg")


@pytest.mark.parametrize("name", [name for name in FILES if name.startswith("step")])
def test_solids_are_as_kept(name: str) -> None:
    require_kept(name)


@pytest.mark.parametrize("name", ["3mf", "stl"])
def test_meshes_are_as_kept(name: str) -> None:
    require_kept(name)


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_are_as_kept(name: str) -> None:
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
    one, two = (kept.document(each).splitlines() for each in (good, other))
    assert len(one) == len(two)
    assert all(map(kept.same, one, two))


def test_all_kinds_of_files_are_there() -> None:
    kinds = {kind for kind, _, _ in FILES.values()}
    assert kinds == {"dxf", "svg", "step", "3mf", "stl", "gcode"}
