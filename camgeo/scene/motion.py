"""From the segments of a scene to the requests for the motion plan."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE
from camgeo.motion.plan import Dwell
from camgeo.motion.planning.request import MoveRequest, PointsRequest, Request, TableRequest, Unit
from camgeo.motion.spans import FULL_TURN
from camgeo.scene.inside import Inside
from camgeo.scene.keys import Path
from camgeo.scene.schema import INFLECTION, SHAPES

EQUAL: Final = "equal-"
"""Prefix of words for the inflection point that makes both parts of a law equal in something."""

UNITS: Final = {
    "mm": ("mm",),
    "inch": ("inch", "in", '"'),
    "deg": ("deg", "degree", "degrees", "°"),
}
"""Spellings of the units that the heading of a lift table may name."""


class MotionRequests:
    """The segments of a valid scene as requests.

    Attributes
    ----------
    all : in the order of the scene.
    unit : of positions in the scene.
    """

    def __init__(self, inside: Inside) -> None:
        values = inside.values
        self.inside = inside
        self.values = values
        self.all: list[Request] = []
        self._scale = math.radians(1.0) if values.angular else values.mm
        self.unit = Unit("deg" if values.angular else values.unit, self._scale)
        for index in range(values.segments):
            request = self._request(("motion", index))
            if request is not None:
                self.all.append(request)

    def _request(self, place: Path) -> Request | None:
        dwell = self.values.exact(*place, "dwell")
        if dwell is not None:
            return Dwell(dwell)
        table: dict[str, Any] = self.values.get(*place)
        span = self.values.exact(*place, "span") or Decimal(0)
        if table["law"] == "table":
            return self._table(place, table, span)
        end = {key: self._scaled(table.get(key)) for key in ("velocity", "acceleration")}
        to = self._scale * table["to"]
        if table["law"] == "points":
            return self._points(place, table, span, to, end)
        inflection = table.get(INFLECTION)
        balance = inflection.removeprefix(EQUAL) if isinstance(inflection, str) else ""
        return MoveRequest(
            span=span,
            to=to,
            law=table["law"],
            parameters={
                key: float(table[key])
                for key in SHAPES
                if key in table and not (balance and key == INFLECTION)
            },
            jerk=self._scaled(table.get("jerk")),
            optimise=_weights(table.get("optimise")),
            balance=balance,
            **end,
        )

    def _scaled(self, value: float | None) -> float | None:
        return None if value is None else self._scale * value

    def _points(
        self,
        place: Path,
        table: dict[str, Any],
        span: Decimal,
        to: float,
        end: dict[str, float | None],
    ) -> PointsRequest | None:
        shares: list[float] = []
        last = Decimal(0)
        for index in range(len(table["points"])):
            at = self.values.exact(*place, "points", index, "at")
            assert at is not None  # the scene is valid
            if not last < at < span:
                message = f"must ascend, inside the span of {span.normalize():f} degrees"
                self.inside.fault((*place, "points", index, "at"), message)
                return None
            shares.append(float(at / span))
            last = at
        given = {
            index: (self._scaled(point.get("velocity")), self._scaled(point.get("acceleration")))
            for index, point in enumerate(table["points"])
        }
        return PointsRequest(
            span=span,
            to=to,
            shares=np.array(shares),
            positions=np.array([self._scale * point["to"] for point in table["points"]]),
            given={index: boundary for index, boundary in given.items() if boundary != FREE},
            **end,
        )

    def _table(self, place: Path, table: dict[str, Any], span: Decimal) -> TableRequest | None:
        from camgeo.motion.motion_tables import read_lift_table  # few scenes have one

        key = (*place, "file")
        data = self.inside.read(key)
        if data is None:
            return None
        try:
            rows = read_lift_table(data, table["file"], float(span), periodic=span == FULL_TURN)
        except GeometryError as error:
            self.inside.fault(key, error.message)
            return None
        wanted = "deg" if self.values.angular else self.values.unit
        if rows.unit and rows.unit.lower() not in UNITS[wanted]:
            self.inside.fault(key, f"gives the lift in {rows.unit}; the scene takes it in {wanted}")
            return None
        return TableRequest(
            span=span,
            shares=rows.first / float(span),
            lifts=self._scale * rows.second,
            smoothing=self._scaled(table.get("smoothing")),
        )


def _weights(optimise: Any) -> dict[str, float]:
    """Weights of the quantities to be kept small."""
    if optimise is None:
        return {}
    return {optimise: 1.0} if isinstance(optimise, str) else dict(optimise)
