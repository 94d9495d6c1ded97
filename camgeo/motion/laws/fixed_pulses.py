"""Laws of two pulses whose only parameter of their own is the inflection point.

The sines are of the SCCA family, see `camgeo.motion.laws.pulse.sine_pulse`.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Final

from camgeo.motion.laws.family import Family, pulse_family
from camgeo.motion.laws.pulse import Pulse, polynomial_pulse, sine_pulse


def _sines(sine: str, constant: str, cosine: str) -> Pulse:
    return sine_pulse(Decimal(sine), Decimal(constant), Decimal(cosine))


CONSTANT = _sines("0", "1", "0")
COSINE = _sines("0", "0", "1")
WHOLE_SINE = _sines("0.5", "0", "0.5")
TRAPEZOID = _sines("0.25", "0.5", "0.25")
TRAPEZOID_TURN = _sines("0", "0.75", "0.25")
MODIFIED = _sines("0.25", "0", "0.75")

PARABOLA = polynomial_pulse((0, 2, -3, 1))
"""a = x (1 - x)(2 - x): f'' = 60 z (1 - z)(1 - 2 z) with z = x/2."""

QUARTIC = polynomial_pulse((0, 0, 4, -8, 5, -1))
"""a = x^2 (2 - x)^2 (1 - x): f'' = 420 z^2 (1 - z)^2 (1 - 2 z) with z = x/2."""

FAMILIES: Final[tuple[Family, ...]] = (
    # Quadratic parabola (Quadratische Parabel), VDI 2143-1 eqs. (24) to (29): constant
    # acceleration, the smallest of all laws from rest to rest, with three jerks.
    pulse_family("quadratic-parabola", {"R-R": (CONSTANT, CONSTANT)}),
    # Simple sine (Einfache Sinuslinie), VDI 2143-1 eqs. (30) to (32) and section 6.3.2. From turn
    # to turn it is free of jerks; from rest to rest f'' jumps at both ends.
    pulse_family("simple-sine", dict.fromkeys(("R-R", "U-U"), (COSINE, COSINE))),
    # 3-4-5 polynomial (Polynom 5. Grades), VDI 2143-1 eqs. (33) to (35).
    pulse_family("polynomial-345", {"R-R": (PARABOLA, PARABOLA)}),
    # 4-5-6-7 polynomial: f = 35 z^4 - 84 z^5 + 70 z^6 - 20 z^7, with f''' = 0 at both ends: the
    # 3-4-5 polynomial with the jerk continuous at the rests too (R. L. Norton, Cam Design and
    # Manufacturing Handbook, section 3.5).
    pulse_family("polynomial-4567", {"R-R": (QUARTIC, QUARTIC)}),
    # Inclined sine, cycloidal (Geneigte Sinuslinie, Helling-Bestehorn), VDI 2143-1 (36) to (38).
    pulse_family("inclined-sine", {"R-R": (WHOLE_SINE, WHOLE_SINE)}, aliases=("cycloidal",)),
    # Modified acceleration trapezoid (Modifiziertes Beschleunigungstrapez). From rest to rest VDI
    # 2143-1 eqs. (39) to (56), from rest to turn (151) to (180), from turn to rest its mirror image
    # (203) to (205).
    pulse_family(
        "modified-trapezoid",
        {
            "R-R": (TRAPEZOID, TRAPEZOID),
            "R-U": (TRAPEZOID, TRAPEZOID_TURN),
            "U-R": (TRAPEZOID_TURN, TRAPEZOID),
        },
    ),
    # Modified sine (Modifizierte Sinuslinie, Neklutin). From rest to rest VDI 2143-1 eqs. (57) to
    # (65), between two constant velocities (82) to (110), with the amplitudes that are lost in
    # print; section 6.5 for one constant velocity and a rest.
    pulse_family(
        "modified-sine", dict.fromkeys(("R-R", "G-G", "R-G", "G-R"), (MODIFIED, MODIFIED))
    ),
    # Harmonic combination (Harmonische Kombination): sines before, a quarter of a cosine to the
    # turn. From rest to turn VDI 2143-1 eqs. (181) to (202), from constant velocity to turn (206)
    # to (224); the mirror images for the way back (sections 6.6.3 and 6.8.2).
    pulse_family(
        "harmonic-combination",
        {
            **dict.fromkeys(("R-U", "G-U"), (MODIFIED, COSINE)),
            **dict.fromkeys(("U-R", "U-G"), (COSINE, MODIFIED)),
        },
    ),
)
