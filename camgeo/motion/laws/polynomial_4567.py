"""4-5-6-7 polynomial: f = 35 z^4 - 84 z^5 + 70 z^6 - 20 z^7, with f''' = 0 at both ends.

The 3-4-5 polynomial with the jerk continuous at the rests too; R. L. Norton, Cam Design and
Manufacturing Handbook, section 3.5.
"""

from __future__ import annotations

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import polynomial_pulse

PULSE = polynomial_pulse((0, 0, 4, -8, 5, -1))
"""a = x^2 (2 - x)^2 (1 - x): f'' = 420 z^2 (1 - z)^2 (1 - 2 z) with z = x/2."""

FAMILY = pulse_family("polynomial-4567", {"R-R": (PULSE, PULSE)})
