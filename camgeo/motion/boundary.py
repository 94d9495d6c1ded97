"""Boundary values of a motion: velocity and acceleration at a point, as far as they are known."""

from __future__ import annotations

from typing import Final

Boundary = tuple[float | None, float | None]
"""Velocity s' and acceleration s'' at a point; None where it is free."""

FREE: Final[Boundary] = (None, None)
