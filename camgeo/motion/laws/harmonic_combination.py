"""Harmonic combination (Harmonische Kombination): sines before, a quarter of a cosine to the turn.

From rest to turn VDI 2143-1 eqs. (181) to (202), from constant velocity to turn (206) to (224); the
mirror images for the way back (sections 6.6.3 and 6.8.2).
"""

from __future__ import annotations

from camgeo.motion.laws import modified_sine, simple_sine
from camgeo.motion.laws.family import pulse_family

START, TURN = modified_sine.PULSE, simple_sine.PULSE

FAMILY = pulse_family(
    "harmonic-combination",
    {"R-U": (START, TURN), "U-R": (TURN, START), "G-U": (START, TURN), "U-G": (TURN, START)},
)
