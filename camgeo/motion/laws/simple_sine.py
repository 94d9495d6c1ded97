"""Simple sine (Einfache Sinuslinie), VDI 2143-1 eqs. (30) to (32) and section 6.3.2.

From turn to turn it is free of jerks; from rest to rest f'' jumps at both ends.
"""

from __future__ import annotations

from decimal import Decimal

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import sine_pulse

PULSE = sine_pulse(Decimal(0), Decimal(0), Decimal(1))

FAMILY = pulse_family("simple-sine", {"R-R": (PULSE, PULSE), "U-U": (PULSE, PULSE)})
