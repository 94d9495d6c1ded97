"""What `camgeo table` finds, as CSV."""

from __future__ import annotations

from camgeo.answers.table import ValueTable
from camgeo.files.value_table import Table


def text(answer: ValueTable) -> str:
    """The table as CSV."""
    if answer.printed is None:
        return answer.table.csv().rstrip("\n")
    return "\n".join(",".join(row) for row in (answer.table.names, *answer.printed))


def table(answer: ValueTable) -> Table:
    """The table."""
    return answer.table
