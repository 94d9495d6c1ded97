"""Nothing rests on comparing data classes that hold arrays or NaN.

Two arrays have no single answer to ==, and a NaN equals nothing, itself included; up to Python 3.12
data classes are compared as tuples, which take the same object for equal, from 3.13 on they are
not. So such classes are compared by identity, `eq=False`.
"""

from __future__ import annotations

import ast
import dataclasses
import importlib
import pkgutil
import re
from collections.abc import Iterator
from typing import Any, Final

import pytest

import camgeo
import camgeo_export
from tests.test_house import modules

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
