"""The table ``[effects.load]``: the process load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.errors import GeometryError

if TYPE_CHECKING:
    from camgeo.effects.load.profile import LoadProfile

KINDS: Final = ("constant", "segments", "file")


@dataclass(frozen=True, slots=True)
class ProcessLoad:
    """The process load; exactly one of the three is not None.

    Attributes
    ----------
    constant : [N or N m].
    segments : one value for each segment of the motion of non-zero length [N or N m].
    table : from a file.
    """

    constant: float | None = None
    segments: tuple[float, ...] | None = None
    table: LoadProfile | None = None


def parse(table: Mapping[str, Any]) -> ProcessLoad:
    """The data of the table.

    Raises
    ------
    GeometryError
        If not exactly one of the keys is given; with key "file", if the file does not have the
        format in the schema, with angles that ascend from 0 to 360 degrees.
    """
    given = [key for key in KINDS if key in table]
    if len(given) != 1:
        found = " and ".join(given) if given else "none"
        raise GeometryError(
            f"exactly one of {', '.join(KINDS)} is needed, and the scene gives {found}",
            key=given[1] if given else "",
        )
    file = table.get("file")
    if file is None:
        return ProcessLoad(**table)
    from camgeo.effects.load.profile import read_load_table  # few loads are in a file

    try:
        return ProcessLoad(table=read_load_table(file))
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error
