"""Quadratic parabola (Quadratische Parabel), VDI 2143-1 eqs. (24) to (29): constant acceleration.

The least acceleration of all laws from rest to rest, with three jerks.
"""

from __future__ import annotations

from decimal import Decimal

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import sine_pulse

PULSE = sine_pulse(Decimal(0), Decimal(1), Decimal(0))

FAMILY = pulse_family("quadratic-parabola", {"R-R": (PULSE, PULSE)})
