"""Polynomial of velocity and acceleration at both ends, for every motion task."""

from __future__ import annotations

from camgeo.motion.laws.polynomials import complete

FAMILY = complete("polynomial-5", "va")
