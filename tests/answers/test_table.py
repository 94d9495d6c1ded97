"""The result of `camgeo table`, rendered as CSV and as JSON."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal

from camgeo.app.answers.answer import table, text
from camgeo.app.answers.table import table_of_scene
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document


def test_text_and_document_are_of_one_result() -> None:
    found = table_of_scene(Design(load_scene(FIXTURES / "scenes" / "inch.toml")), Decimal(45))
    columns = document(found)["columns"]
    head, *rows = text(found).splitlines()
    assert head.split(",") == list(columns)
    assert [float(row.split(",")[1]) for row in rows] == list(columns.values())[1]
    values = found.table.values.copy()
    values[1, 1] = 12345.5
    other = replace(found, table=Table(found.table.names, values))
    assert list(document(other)["columns"].values())[1][1] == 12345.5
    assert text(other).splitlines()[2].split(",")[1] == "12345.5"
    assert table(other) is other.table
