"""Polynomials of given boundary values, for every motion task.

`polynomial-5` meets velocity and acceleration at both ends (VDI 2143-1 section 6.4, eqs. (131) to
(150), and its kin in 6.7, 6.9 and 6.10), `polynomial-7` the jerk as well. `polynomial` meets only
what is given, with the lowest degree possible. Any of them may overshoot.
"""

from __future__ import annotations

from typing import Final

from camgeo.motion.boundary import TASKS
from camgeo.motion.laws.family import Family, Given, boundary_parameters
from camgeo.motion.laws.law import Law
from camgeo.motion.laws.two_point import law_of_boundary_values


def _complete(name: str, orders: str) -> Family:
    """The family that meets these orders at both ends, 0 where they are not given."""

    def make(task: str, given: Given) -> Law:
        values = {order + end: given.get(order + end, 0.0) for end in "01" for order in orders}
        return law_of_boundary_values(name, task, values, given)

    return Family(name, {task: boundary_parameters(task, orders) for task in TASKS}, make)


def _of_what_is_given(task: str, given: Given) -> Law:
    return law_of_boundary_values("polynomial", task, given, given)


FAMILIES: Final[tuple[Family, ...]] = (
    _complete("polynomial-5", "va"),
    _complete("polynomial-7", "vaj"),
    Family("polynomial", {"B-B": ("v0", "a0", "j0", "v1", "a1", "j1")}, _of_what_is_given),
)
