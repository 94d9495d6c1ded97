"""Modified sine (Modifizierte Sinuslinie, Neklutin).

From rest to rest VDI 2143-1 eqs. (57) to (65), between two constant velocities (82) to (110), with
the amplitudes that are lost in print; section 6.5 for one constant velocity and a rest.
"""

from __future__ import annotations

from decimal import Decimal

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import sine_pulse

PULSE = sine_pulse(Decimal("0.25"), Decimal(0), Decimal("0.75"))

FAMILY = pulse_family("modified-sine", dict.fromkeys(("R-R", "G-G", "R-G", "G-R"), (PULSE, PULSE)))
