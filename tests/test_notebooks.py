"""The example notebooks run, and are kept without what they show.

Here their cells run in this process, with what a notebook asks of each result; a kernel is started
for them in the long form, see `.ci/full`.
"""

from __future__ import annotations

import ast
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import pytest

from camgeo.record import Displayed
from tests.hostile_scene import Page, harmless
from tests.long_form import LONG

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"

NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


LONG_CELL: Final = {"tags": ["long"]}
"""Metadata of cells that take seconds; nothing below needs what they make."""


def cells(path: Path, kind: str, *, long: bool = True) -> list[str]:
    """The sources of its cells of one kind, with those that take long or without."""
    found = json.loads(path.read_text("utf-8"))
    return [
        "".join(each["source"])
        for each in found["cells"]
        if each["cell_type"] == kind and (long or each["metadata"] != LONG_CELL)
    ]


def results(path: Path) -> Iterator[Any]:
    """Run the cells one after the other; what each shows, or None."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for number, source in enumerate(cells(path, "code", long=LONG)):
        tree = ast.parse(source, f"{path.name}[{number}]")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, path.name, "exec"), names)
        if last is None:
            yield None
        else:
            assert isinstance(last, ast.Expr)
            yield eval(compile(ast.Expression(last.value), path.name, "eval"), names)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FOLDER)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    plt.switch_backend("agg")
    pictures = widgets = 0
    for result in results(path):
        if isinstance(result, Displayed):
            found = result._repr_mimebundle_()
            html = found["text/html"]
            assert isinstance(html, str)
            assert harmless(Page(html))
            pictures += "image/png" in found
        elif hasattr(result, "_repr_png_"):
            pictures += bool(result._repr_png_())
        elif hasattr(result, "get_state"):
            widgets += 1
    plt.close("all")
    assert pictures >= 1
    assert widgets == (path.stem == "plan")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_what_it_shows(path: Path) -> None:
    found = json.loads(path.read_text("utf-8"))
    assert json.dumps(found, indent=1, ensure_ascii=False) + "\n" == path.read_text("utf-8")
    assert (found["nbformat"], found["nbformat_minor"]) == (4, 5)
    identifiers = [each["id"] for each in found["cells"]]
    assert len(set(identifiers)) == len(identifiers)
    for each in found["cells"]:
        assert each["metadata"] in ({}, LONG_CELL)
        if each["cell_type"] == "code":
            assert (each["execution_count"], each["outputs"]) == (None, [])
    assert cells(path, "markdown")[0].startswith("# ")


def test_there_are_notebooks_and_a_page_that_names_them() -> None:
    page = (FOLDER.parent / "notebook.md").read_text("utf-8")
    assert len(NOTEBOOKS) == 3
    assert all(f"](notebooks/{path.name})" in page for path in NOTEBOOKS)
