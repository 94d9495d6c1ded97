"""Inclined sine, cycloidal (Geneigte Sinuslinie, Helling-Bestehorn), VDI 2143-1 (36) to (38)."""

from __future__ import annotations

from decimal import Decimal

from camgeo.motion.laws.family import pulse_family
from camgeo.motion.laws.pulse import sine_pulse

PULSE = sine_pulse(Decimal("0.5"), Decimal(0), Decimal("0.5"))

FAMILY = pulse_family("inclined-sine", {"R-R": (PULSE, PULSE)}, aliases=("cycloidal",))
