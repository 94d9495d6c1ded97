"""What `camgeo table` finds, as CSV."""

from __future__ import annotations

from camgeo.answers.table import ValueTable
from camgeo.product.value_table import Table


def text(answer: ValueTable) -> str:
    """The table as CSV."""
    return answer.table.csv().rstrip("\n")


def table(answer: ValueTable) -> Table:
    """The table."""
    return answer.table
