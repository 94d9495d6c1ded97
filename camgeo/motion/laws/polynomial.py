"""Polynomial of the boundary values that are given and of no others, of the least degree."""

from __future__ import annotations

from camgeo.motion.laws.family import Family, Given
from camgeo.motion.laws.law import Law
from camgeo.motion.laws.two_point import law_of_boundary_values


def _make(task: str, given: Given) -> Law:
    return law_of_boundary_values("polynomial", task, given, given)


FAMILY = Family("polynomial", {"B-B": ("v0", "a0", "j0", "v1", "a1", "j1")}, _make)
