"""3-4-5 polynomial (Polynom 5. Grades), VDI 2143-1 eqs. (33) to (35)."""

from __future__ import annotations

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import polynomial_pulse

PULSE = polynomial_pulse((0, 2, -3, 1))
"""a = x (1 - x)(2 - x): f'' = 60 z (1 - z)(1 - 2 z) with z = x/2."""

FAMILY = pulse_family("polynomial-345", {"R-R": (PULSE, PULSE)})
