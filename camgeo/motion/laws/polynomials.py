"""Polynomials of given boundary values, for every motion task.

`polynomial-5` meets velocity and acceleration at both ends (VDI 2143-1 section 6.4, eqs. (131) to
(150), and its kin in 6.7, 6.9 and 6.10), `polynomial-7` the jerk as well. `polynomial` meets what
is given and nothing else, with the least degree that
can. Any of them may overshoot.
"""

from __future__ import annotations

from camgeo.motion.laws.family import Family, Given, boundary_parameters
from camgeo.motion.laws.law import Law
from camgeo.motion.laws.two_point import law_of_boundary_values
from camgeo.motion.task import TASKS

ORDERS = {"v": 1, "a": 2, "j": 3}


def _complete(name: str, orders: str) -> Family:
    def make(task: str, given: Given) -> Law:
        values = {order + end: given.get(order + end, 0.0) for end in "01" for order in orders}
        return _law(name, task, values, given)

    parameters = {task: boundary_parameters(task, orders) for task in TASKS}
    return Family(name, parameters, make)


def _law(name: str, task: str, values: Given, given: Given) -> Law:
    start = {ORDERS[key[0]]: value for key, value in values.items() if key[1] == "0"}
    end = {ORDERS[key[0]]: value for key, value in values.items() if key[1] == "1"}
    return law_of_boundary_values(name, task, start, end, given)


def _make_free(task: str, given: Given) -> Law:
    return _law("polynomial", task, given, given)


POLYNOMIAL_5 = _complete("polynomial-5", "va")
POLYNOMIAL_7 = _complete("polynomial-7", "vaj")
POLYNOMIAL = Family("polynomial", {"B-B": ("v0", "a0", "j0", "v1", "a1", "j1")}, _make_free)
