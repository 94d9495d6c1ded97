"""What a scene says of the load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.errors import GeometryError

if TYPE_CHECKING:
    from camgeo.effects.load.course import Course

KINDS: Final = ("constant", "segments", "file")


@dataclass(frozen=True, slots=True)
class LoadSpec:
    """The table ``[effects.load]``; one of the three is not None.

    Attributes
    ----------
    constant : [N or N m].
    segments : one value for each segment of the motion that has a length [N or N m].
    table : what a file says.
    """

    constant: float | None = None
    segments: tuple[float, ...] | None = None
    table: Course | None = None


def parse(table: Mapping[str, Any]) -> LoadSpec:
    """The table, numbers converted.

    Raises
    ------
    GeometryError
        If not exactly one of the keys is given; with key "file", if the file is not as the scene's
        schema says: its angles are to ascend from 0 to 360 degrees.
    """
    given = [key for key in KINDS if key in table]
    if len(given) != 1:
        found = " and ".join(given) if given else "none"
        raise GeometryError(
            f"one of {', '.join(KINDS)} is needed, given is {found}",
            key=given[1] if given else "",
        )
    file = table.get("file")
    if file is None:
        return LoadSpec(**table)
    from camgeo.effects.load.course import read_load_table  # few loads are in a file

    try:
        return LoadSpec(table=read_load_table(file))
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error
