"""The real outline by its definition: where W(x) = W(y), the remaining area, where the roller
rests.

Nothing here is shared with the engine: crossings are roots of two equations in series of the cam
angle, areas are Green's integral over the exact flank, and the roller that rests against a corner
is found by Pythagoras and the law of cosines.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, singledispatch
from itertools import pairwise
from typing import Any, Final

from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from tests.stability.cams import CamSpec
from tests.stability.exact_cam import AnyFollower, CamJet
from tests.stability.series import (
    STEPS,
    Number,
    Series,
    direction,
    logarithm,
    newton,
    root,
    variable,
)

ENOUGH: Final = 24
"""A step that vanishes to this many decimals is the last one. Its error is its square over the
width of the tail, 1e-43 rad for a width of 1e-5; half an ulp of the inputs moves a place by 1e-17
or more."""

DEGREE: Final = 5
"""Degree of mpmath's Gauss-Legendre quadrature: 48 nodes. They give 18 digits of an area on each
piece of a move; a double has 16."""

ROLLER: Final = 6
"""Index of r_R among the numbers."""

Numbers = Sequence[Number]


@dataclass(frozen=True, slots=True)
class ExactOutline:
    """A flank over a full turn: rest, rise, rest, return, rest.

    The methods take the exact numbers of `parameters`.

    Attributes
    ----------
    spec : the cam.
    side : -1 for the inner flank, +1 for the outer one.
    """

    spec: CamSpec
    side: int

    @property
    def parameters(self) -> tuple[float, ...]:
        """The inputs: joints of rise and return [rad], stroke, lambda, and the follower's."""
        rise, back = self.spec.parameters(back=False), self.spec.parameters(back=True)
        return (*rise[:2], *back[:2], self.spec.stroke, *rise[4:])

    def jet(self, phi: Number, numbers: Numbers, terms: int) -> CamJet:
        """The cam at the cam angle `phi` [rad] in [0, 2 pi)."""
        up, top, down, last, stroke, *rest = numbers
        zero = mp.mpf(0)
        stage = self.spec.stage
        if phi < down:
            # In a rest both ends of the move are at the same lift.
            low, high = (zero, stroke) if phi < top else (stroke, stroke)
            low, high = (zero, zero) if phi < up else (low, high)
            return stage.jet(phi, (up, top, low, high, *rest), terms)
        low, high = (stroke, zero) if phi < last else (zero, zero)
        return stage.jet(phi, (down, last, low, high, *rest), terms)

    def flank(self, phi: Number, numbers: Numbers) -> tuple[Number, Number]:
        """W and W'."""
        jet = self.jet(phi, numbers, 3)
        point, pace = jet.flank(self.side * jet.roller).terms
        return point, pace

    def crossing(
        self, guesses: tuple[Number, Number], numbers: Numbers
    ) -> tuple[Number, Number, Number]:
        """x < y with W(x) = W(y) near `guesses` [rad], and the point [mm], by Newton's steps.

        Raises
        ------
        GeometryError
            If there is no crossing there: the steps do not converge, or converge to x = y.
        """
        x, y = (mp.mpf(guess) for guess in guesses)
        apart = y - x
        for _ in range(STEPS):
            (at_x, slope_x), (at_y, slope_y) = self.flank(x, numbers), self.flank(y, numbers)
            gap = at_y - at_x
            # slope_x dx - slope_y dy = gap
            area = mp.im(mp.conj(slope_x) * slope_y)
            if area == 0:
                break
            dx = mp.im(mp.conj(slope_y) * gap) / -area
            dy = mp.im(mp.conj(slope_x) * gap) / -area
            x, y = x + dx, y + dy
            if abs(dx) + abs(dy) < mp.mpf(10) ** -ENOUGH:
                break
        else:
            raise GeometryError("the flank does not cross itself there")
        if not abs(y - x) > apart / 2:
            raise GeometryError("the flank does not cross itself there")
        return x, y, self.flank(x, numbers)[0]

    def area(self, x: Number, y: Number, numbers: Numbers) -> Number:
        """Area [mm^2] inside the flank without the cam angles from `x` to `y` [rad].

        With W = Z + d n, where the normal n turns by theta, Green's integral consists of that of
        the pitch curve, of its length, and of the terms of the ends (Steiner's formula):

            1/2 int Im(conj Z Z') - sigma d int |Z'| + d^2/2 (turn of n) + d/2 [Im(conj Z n)].
        """
        sector = length = turn = mp.mpf(0)
        ends: list[Number] = []
        normal: Number = None
        for low, high, many in self._stretches(x, y, numbers):
            half, middle = (high - low) / 2, (high + low) / 2
            inner = _nodes() if many else ((mp.mpf(0), mp.mpf(2)),)
            for node, weight in ((-1, 0), *inner, (1, 0)):
                jet = self.jet(middle + half * node, numbers, 2)
                z, z1 = jet.centre.terms
                sector += weight * half * mp.im(mp.conj(z) * z1) / 2
                length += weight * half * abs(z1)
                before, normal = normal, mp.mpc(0, jet.rotation) * z1 / abs(z1)
                turn += mp.arg(normal * mp.conj(before)) if before is not None else 0
                ends = [*ends[:1], mp.im(mp.conj(z) * normal)]
        d = self.side * numbers[ROLLER]
        whole = sector - self.spec.rotation * d * length + d**2 * turn / 2
        return abs(whole + d * (ends[1] - ends[0]) / 2)

    def _stretches(
        self, x: Number, y: Number, numbers: Numbers
    ) -> Iterator[tuple[Number, Number, bool]]:
        """The remaining ranges of moves (True) and rests (False), in order from y to x + 2 pi."""
        joints = (mp.mpf(0), *numbers[:4], 2 * mp.pi)
        pieces = [(a, b, k % 2 == 1) for k, (a, b) in enumerate(pairwise(joints)) if a < b]
        yield from ((max(a, y), b, moves) for a, b, moves in pieces if b > y)
        yield from ((a, min(b, x), moves) for a, b, moves in pieces if a < x)

    def actual(self, phi: Number, corner: Number, numbers: Numbers, terms: int) -> Series:
        """Lift [mm or rad] of the roller against `corner` [mm] at the cam angle `phi` [rad]."""
        sigma, follower = self.spec.rotation, self.spec.follower
        seen = corner * direction(variable(sigma * phi, sigma, terms))
        roller, base, *rest = numbers[ROLLER:]
        return _lifted(follower, seen, -self.side * roller, base, *rest)

    def loss(self, phi: Number, corner: Number, numbers: Numbers, terms: int) -> Series:
        """Lost stroke [mm or rad] at the cam angle `phi` [rad], the roller against `corner` [mm].

        Positive where the roller gets farther into the disc than demanded.
        """
        actual = self.actual(phi, corner, numbers, terms)
        demanded = self.jet(phi, numbers, terms).lift
        loss: Series = (actual - demanded) * (self.side * _outward(self.spec.follower))
        return loss

    def place_of_largest_loss(self, guess: Number, corner: Number, numbers: Numbers) -> Number:
        """Cam angle [rad] near `guess` at which the lost stroke is stationary.

        GeometryError if there is no such angle.
        """

        def slope(phi: Number) -> tuple[Number, Number]:
            loss = self.loss(phi, corner, numbers, 3)
            return loss.terms[1], loss.derivative(2)

        return newton(slope, guess, ENOUGH)


@singledispatch
def _lifted(follower: Any, *_: Any) -> Series:
    """Lift of a roller whose centre is |roller| from `corner`, beyond it if positive."""
    raise TypeError(type(follower))


@_lifted.register
def _guided(
    follower: TranslatingRoller,
    corner: Series,
    roller: Number,
    base: Number,
    offset: Number,
    guide: Number,
) -> Series:
    """The lift on a guide: by Pythagoras."""
    seen = corner * mp.expj(-guide)
    across = seen.imag + offset
    height = seen.real + root(roller**2 - across * across) * (follower.direction * mp.sign(roller))
    lift: Series = (height - mp.sqrt(base**2 - offset**2)) * follower.direction
    return lift


@_lifted.register
def _swung(
    follower: OscillatingRoller,
    corner: Series,
    roller: Number,
    base: Number,
    x: Number,
    y: Number,
    arm: Number,
) -> Series:
    """The lift on a rocker: the triangle of pivot, corner and roller centre."""
    pivot = mp.mpc(x, y)
    distance = abs(pivot)
    start = mp.acos((distance**2 + arm**2 - base**2) / (2 * distance * arm))
    apart = corner - pivot
    square = apart.real * apart.real + apart.imag * apart.imag
    cosine = (square + (arm**2 - roller**2)) / (2 * arm * root(square))
    between = logarithm(cosine + root(1 - cosine * cosine) * mp.mpc(0, 1)).imag
    # Angles measured from the line to the cam axis, towards the rocker's side of it.
    towards = logarithm(apart / -pivot).imag * follower.arm_side
    lift: Series = (towards + between * mp.sign(roller) - start) * _outward(follower)
    return lift


def _outward(follower: AnyFollower) -> int:
    """+1 if a positive lift moves the roller outward, else -1."""
    assert follower.direction is not None  # of a follower without a linkage
    return follower.direction


def _nodes() -> Sequence[tuple[Number, Number]]:
    """Nodes in (-1, 1), ascending, and weights; mpmath caches them."""
    found: Sequence[tuple[Number, Number]] = sorted(_rule().get_nodes(-1, 1, DEGREE, mp.prec))
    return found


@cache
def _rule() -> Any:
    """mpmath's Gauss-Legendre quadrature."""
    from mpmath.calculus.quadrature import GaussLegendre

    return GaussLegendre(mp)
