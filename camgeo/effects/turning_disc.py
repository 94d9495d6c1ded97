"""The disc as a body that turns with the camshaft."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from camgeo.errors import EffectError, GeometryError

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.numeric.arrays import ComplexArray, FloatArray
    from camgeo.part.part import Part


def part_of(subject: Subject, purpose: str) -> Part:
    """The part; EffectError, that there is no disc for the `purpose`, if it does not exist."""
    try:
        return subject.made.part
    except GeometryError as error:
        if error.key:
            raise
        raise EffectError(f"there is no disc to {purpose}: {error.message}") from error


def unbalance_force(
    unbalance: complex, rotation: int, phi: FloatArray, rates: FloatArray
) -> ComplexArray:
    """(n,) [N] inertia force of an unbalance [t mm] on the shaft, in the axes of the frame.

    The centre of mass is at U/m exp(i sigma phi). Minus m times its second derivative is
    U exp(i sigma phi) (omega^2 - i sigma alpha): the centrifugal force U omega^2, and at
    varying speed the tangential one (Norton, "Machine Design", chapter on balancing, for the
    first; the second derivative gives both).
    """
    turned = unbalance * np.exp(1j * rotation * phi)
    found: ComplexArray = turned * (rates[0] ** 2 - 1j * rotation * rates[1])
    return found
