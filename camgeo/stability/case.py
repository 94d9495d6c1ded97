"""A case of the stability suite: quantities at some places, in doubles and with many digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.stability.high_precision import Number

Found = Callable[[FloatArray], tuple[FloatArray | ComplexArray, ...]]
Exact = Callable[..., tuple[Number, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """Some quantities of one law, table, linkage or cam, at some places.

    The inputs are doubles, each taken for exactly the number that it is.

    Attributes
    ----------
    group : what part of the suite it belongs to, see `camgeo.stability.suite.GROUPS`.
    name : what is hard about it, one word or a few.
    quantities : names of what is computed.
    places : (n,) the first input: z of a law, else the cam angle or the crank angle [rad]; of a
        root, a guess.
    parameters : the other inputs, in the order in which `exact` takes them.
    found : places (n,) -> an array (n,) for each quantity: what camgeo computes, real or complex.
    exact : place, parameters -> the quantities by formulas of their own, numbers of mpmath. Called
        with the inputs themselves, and with each in turn changed by half an ulp.
    """

    group: str
    name: str
    quantities: tuple[str, ...]
    places: tuple[float, ...]
    parameters: tuple[float, ...]
    found: Found
    exact: Exact
