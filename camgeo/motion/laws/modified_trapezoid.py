"""Modified acceleration trapezoid (Modifiziertes Beschleunigungstrapez).

From rest to rest VDI 2143-1 eqs. (39) to (56), from rest to turn (151) to (180), from turn to rest
its mirror image (203) to (205).
"""

from __future__ import annotations

from decimal import Decimal

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import sine_pulse

REST = sine_pulse(Decimal("0.25"), Decimal("0.5"), Decimal("0.25"))
TURN = sine_pulse(Decimal(0), Decimal("0.75"), Decimal("0.25"))

FAMILY = pulse_family(
    "modified-trapezoid", {"R-R": (REST, REST), "R-U": (REST, TURN), "U-R": (TURN, REST)}
)
