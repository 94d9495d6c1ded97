"""Conversion between the units of a scene and those inside: millimetres and radians.

Values are converted once: by the scene loader on the way in, by a writer on the way out.
"""

from __future__ import annotations

import math
from typing import Final, Literal

LengthUnit = Literal["mm", "inch"]

LiftUnit = Literal["mm", "rad"]
"""Unit of a lift or of a demanded position, inside."""

MM_PER: Final[dict[LengthUnit, float]] = {"mm": 1.0, "inch": 25.4}

TURN: Final = 2.0 * math.pi
"""One turn of the cam [rad]."""

RPM: Final = TURN / 60.0
"""One rev/min in rad/s."""
