"""Planning: from what a designer states at a few angles to a plan whose laws join smoothly."""

from __future__ import annotations

from camgeo.motion.planning.planner import plan_motion
from camgeo.motion.planning.request import (
    AUTO,
    CRITERIA,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)

__all__ = [
    "AUTO",
    "CRITERIA",
    "MoveRequest",
    "PointsRequest",
    "Request",
    "TableRequest",
    "Unit",
    "plan_motion",
]
