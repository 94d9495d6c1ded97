"""Limits of size: lines of a module, imports and members of the design; reasons of exceptions."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from camgeo.design import Design
from tests.test_architecture import ROOT, find_imports, find_modules

MOST_LINES = 400
"""Lines of a module of camgeo or its writers."""

MOST_IMPORTS = 20
"""Imports of camgeo's modules by the design, including those inside functions."""

MOST_MEMBERS = 20
"""Public ones of a design; it has fewer."""


MOST_METHODS = 15
"""Public methods and properties of a class outside `mechanism`, whose followers answer all stages;
the design has its own limit. Fields do not count: data may have many."""

WITHOUT_REASON = re.compile(
    r"# (?:type: ignore(?!\[[a-z, -]+\]  ?# \w)|noqa(?!: [A-Z0-9, ]+  ?(?:[#-] )?[a-z]))"
)
"""A comment that suppresses a warning without a reason after it."""


def modules() -> list[Path]:
    return [
        path for folder in ("camgeo", "export") for path in sorted((ROOT / folder).rglob("*.py"))
    ]


def too_long(path: Path) -> bool:
    return len(path.read_text("utf-8").splitlines()) > MOST_LINES


def public_members(source: str, name: str) -> list[str]:
    """Public fields, properties and methods of the class `name`."""
    (found,) = (
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ClassDef) and node.name == name
    )
    names = []
    for node in found.body:
        match node:
            case ast.FunctionDef(name=member) | ast.AnnAssign(target=ast.Name(id=member)):
                names.append(member)
    return [each for each in names if not each.startswith("_")]


def test_suppressed_warnings_have_reasons() -> None:
    found = [
        f"{path.relative_to(ROOT)}: {line.strip()}"
        for folder in ("camgeo", "export", "tests", "docs", "benchmarks")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line in path.read_text("utf-8").splitlines()
        if WITHOUT_REASON.search(line)
    ]
    assert found == []


def test_no_module_is_too_long() -> None:
    assert [str(path) for path in modules() if too_long(path)] == []


def test_a_module_that_is_too_long_is_found(tmp_path: Path) -> None:
    path = tmp_path / "long.py"
    path.write_text("\n" * MOST_LINES, "utf-8")
    assert not too_long(path)
    path.write_text("\n" * (MOST_LINES + 1), "utf-8")
    assert too_long(path)


def wide_classes(source: str) -> list[str]:
    """Classes with too many public methods and properties."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ClassDef):
            methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
            if sum(not each.name.startswith("_") for each in methods) > MOST_METHODS:
                found.append(node.name)
    return found


def test_no_class_answers_too_much() -> None:
    rooms = [path for path in modules() if "mechanism" not in path.parts]
    found = {name for path in rooms for name in wide_classes(path.read_text("utf-8"))}
    assert found <= {"Design"}


def test_a_class_that_answers_too_much_is_found() -> None:
    methods = "".join(f"    def ask{k}(self): ...\n" for k in range(MOST_METHODS))
    assert wide_classes(f"class Room:\n    size: int\n{methods}    def _own(self): ...\n") == []
    assert wide_classes(f"class Room:\n{methods}    def more(self): ...\n") == ["Room"]


def test_the_design_reaches_few_modules() -> None:
    path = ROOT / "camgeo" / "design.py"
    known = find_modules(ROOT)
    found = {each.target for each in find_imports(path, "camgeo", known)}
    ours = {name for name in found if name.split(".")[0] == "camgeo"}
    assert {"camgeo.cam.cam", "camgeo.writing.write"} <= ours
    assert len(ours) <= MOST_IMPORTS


def test_the_design_has_few_members() -> None:
    members = public_members((ROOT / "camgeo" / "design.py").read_text("utf-8"), "Design")
    assert {"scene", "cam", "findings", "write"} <= set(members)
    assert len(members) < MOST_MEMBERS
    assert all(hasattr(Design, name) or name in Design.__annotations__ for name in members)


@pytest.mark.parametrize(
    ("body", "members"),
    [
        ("    size: int\n    _own: int = 0\n", ["size"]),
        (
            "    def ask(self): ...\n    @property\n    def reported(self): ...\n",
            ["ask", "reported"],
        ),
        ("    def _ask(self): ...\n    NAME = 1\n", []),
    ],
)
def test_members_are_counted(body: str, members: list[str]) -> None:
    assert public_members(f"class Room:\n{body}", "Room") == members
