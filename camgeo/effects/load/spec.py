"""What a scene says of the load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.effects.load.course import Constant, Course, Steps, Table, read_load_table
from camgeo.errors import GeometryError
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import frozen

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
    table: Table | None = None

    def course(self, plan: MotionPlan, unit: str) -> Course:
        """The load over the cam angle, in `unit`.

        Raises
        ------
        GeometryError
            With key "effects.load.segments", if there is not one value for each segment that has
            a length; with "effects.load.file", if its heading tells another unit.
        """
        if self.table is not None:
            if self.table.unit not in ("", unit):
                raise GeometryError(
                    f"the heading tells loads in {self.table.unit}; of this follower the load is in"
                    f" {unit}",
                    key="effects.load.file",
                )
            return self.table
        if self.segments is None:
            assert self.constant is not None  # `parse` sees to it
            return Constant(self.constant)
        # A rest of no length has no load; the plan of a scene does not keep it either.
        pairs = zip(plan.segments, plan.joints_deg[:-1], strict=True)
        starts = [math.radians(float(start)) for segment, start in pairs if segment.span > 0]
        if len(self.segments) != len(starts):
            raise GeometryError(
                f"{len(self.segments)} values for the {len(starts)} segments of the motion that"
                " have a length; allowed is one for each",
                key="effects.load.segments",
            )
        return Steps(frozen(starts, np.float64), frozen(self.segments, np.float64))


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
    try:
        return LoadSpec(table=read_load_table(file))
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error
