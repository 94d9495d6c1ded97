"""Limits of size and of comparison: modules, lines, imports, members; reasons of exceptions.

Two arrays have no single answer to ==, and a NaN equals nothing, itself included; up to Python 3.12
data classes are compared as tuples, which take the same object for equal, from 3.13 on they are
not. So classes that hold such are compared by identity, `eq=False`.
"""

from __future__ import annotations

import ast
import dataclasses
import importlib
import io
import pkgutil
import re
import tokenize
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
import camgeo_export
from camgeo.design.design import Design
from tests.test_architecture import ROOT, find_imports, find_modules

MOST_LINES = 800
"""Lines of code of a module of camgeo or its writers: those with tokens that are no docstring."""

MOST_MODULES = 311
"""Modules of camgeo and its writers."""

MOST_CRUMBS = 42
"""Of these, modules that one other module alone imports."""

MOST_STATEMENTS = 61_466
"""Statements of camgeo and its writers, without docstrings."""

MOST_NAMES = 600
"""Names that modules import from each other of which one module alone imports each."""

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


def lines_of_code(source: str) -> int:
    """Lines with code: without empty ones, comments and docstrings."""
    prose: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            prose.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    idle = {
        tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.COMMENT,
        tokenize.ENDMARKER,
    }  # fmt: skip
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in idle:
            code.update(range(token.start[0], token.end[0] + 1))
    return len(code - prose)


def statements(source: str) -> int:
    """Statements, without docstrings and other texts that stand alone."""
    return sum(
        isinstance(node, ast.stmt)
        and not (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        )
        for node in ast.walk(ast.parse(source))
    )


def crumbs(sources: Mapping[str, str]) -> list[str]:
    """Modules, by their dotted names, that exactly one other of them imports."""
    users: dict[str, set[str]] = {name: set() for name in sources}
    for name, source in sources.items():
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    inner = f"{node.module}.{alias.name}"
                    users.get(inner if inner in users else node.module or "", set()).add(name)
    return [name for name, found in users.items() if len(found - {name}) == 1]


def names_of_one_importer(sources: Mapping[str, str]) -> int:
    """How many names one module alone imports from another one."""
    imported = {
        (node.module, alias.name, importer)
        for importer, source in sources.items()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("camgeo")
        for alias in node.names
    }
    return [*Counter((module, name) for module, name, _ in imported).values()].count(1)


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


def test_modules_are_rooms_and_no_crumbs() -> None:
    sources = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        .removeprefix("export.")
        .removesuffix(".__init__"): path.read_text("utf-8")
        for path in modules()
    }
    assert [name for name, text in sources.items() if lines_of_code(text) > MOST_LINES] == []
    assert len(sources) <= MOST_MODULES
    assert len(crumbs(sources)) <= MOST_CRUMBS
    assert names_of_one_importer(sources) <= MOST_NAMES
    assert sum(map(statements, sources.values())) <= MOST_STATEMENTS


def test_lines_of_code_and_crumbs_are_found() -> None:
    assert (
        lines_of_code('"""One."""\n\n# two\nx = (\n    1\n)\n\n\ndef f():\n    """Three."""\n') == 4
    )
    sources = {
        "a": "x = 1\n",
        "b": "from a import x\n",
        "c": "from a import x\nfrom d import e\n",
        "d.e": "from d import f\n",
        "d": "",
        "d.f": "",
    }
    assert crumbs(sources) == ["d.e", "d.f"]
    assert names_of_one_importer({"a": "from camgeo import y, z", "b": "from camgeo import y"}) == 1


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
    path = ROOT / "camgeo" / "design" / "design.py"
    known = find_modules(ROOT)
    found = {each.target for each in find_imports(path, "camgeo.design", known)}
    ours = {name for name in found if name.split(".")[0] == "camgeo"}
    assert {"camgeo.cam.cam", "camgeo.design.writing"} <= ours
    assert len(ours) <= MOST_IMPORTS


def test_the_design_has_few_members() -> None:
    members = public_members(
        (ROOT / "camgeo" / "design" / "design.py").read_text("utf-8"), "Design"
    )
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


HOLDS_ARRAYS: Final = re.compile(r"Array\b|\bndarray\b")

CALLABLE: Final = re.compile(r"Callable\[\[[^\]]*(?:\[[^\]]*\][^\]]*)*\], [\w.]+(?:\[[^\]]*\])?\]")
"""A field that is a function holds none of what it takes and returns."""

NAN: Final = re.compile(r"\bnan\b", re.IGNORECASE)


def _option(decorator: ast.expr) -> bool | None:
    """Whether a decorator makes a data class with ==; None if it makes no data class."""
    if isinstance(decorator, ast.Call):
        made = _option(decorator.func)
        says = [each.value for each in decorator.keywords if each.arg == "eq"]
        return made and not any(isinstance(each, ast.Constant) and not each.value for each in says)
    name = decorator.attr if isinstance(decorator, ast.Attribute) else getattr(decorator, "id", "")
    return True if name == "dataclass" else None


def _compares(field: ast.AnnAssign) -> bool:
    value = field.value
    return not (
        isinstance(value, ast.Call) and any(each.arg == "compare" for each in value.keywords)
    )


def doubtful(source: str) -> list[str]:
    """Data classes with == whose fields hold arrays, or NaN by their own description."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.ClassDef) or not any(map(_option, node.decorator_list)):
            continue
        fields = [
            ast.unparse(each.annotation)
            for each in node.body
            if isinstance(each, ast.AnnAssign) and _compares(each)
        ]
        arrays = any(HOLDS_ARRAYS.search(CALLABLE.sub("", each)) for each in fields)
        attributes = (ast.get_docstring(node) or "").partition("Attributes\n")[2]
        if arrays or NAN.search(attributes):
            found.append(node.name)
    return found


def test_data_classes_with_arrays_or_nan_are_compared_by_identity() -> None:
    found = {str(path): doubtful(path.read_text("utf-8")) for path in modules()}
    assert {name: each for name, each in found.items() if each} == {}


@pytest.mark.parametrize(
    ("body", "options", "is_found"),
    [
        ("    a: FloatArray\n", "", True),
        ("    a: tuple[ComplexArray, ...] | None\n", "(frozen=True)", True),
        ("    a: FloatArray\n", "(frozen=True, eq=False)", False),
        ("    a: FloatArray = field(compare=False)\n", "", False),
        ("    a: Callable[[FloatArray, Side], FloatArray]\n", "", False),
        ("    a: float\n", "", False),
        ('    """One.\n\n    Attributes\n    ----------\n    a : or NaN.\n    """\n', "", True),
    ],
)
def test_a_class_whose_comparison_is_doubtful_is_found(
    body: str, options: str, is_found: bool
) -> None:
    assert doubtful(f"@dataclass{options}\nclass Own:\n{body}") == ["Own"] * is_found


# -- what is compared ------------------------------------------------------------------------------


def data_classes() -> Iterator[type[Any]]:
    """All of camgeo and its writers."""
    for package in (camgeo, camgeo_export):
        for each in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if each.name.endswith("__main__"):
                continue
            for value in vars(importlib.import_module(each.name)).values():
                if (
                    isinstance(value, type)
                    and value.__module__ == each.name
                    and dataclasses.is_dataclass(value)
                ):
                    yield value


def test_no_class_compared_by_identity_inherits_another_comparison() -> None:
    """It would compare the fields of the class above alone."""
    found = [
        kind.__qualname__
        for kind in data_classes()
        if "__dataclass_params__" in vars(kind)
        and "__eq__" not in vars(kind)
        and any(dataclasses.is_dataclass(each) and "__eq__" in vars(each) for each in kind.__mro__)
    ]
    assert found == []
