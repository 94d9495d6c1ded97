"""Grips of linkages, see `camgeo.designing.grips`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import singledispatch

import numpy as np

from camgeo.designing.grips import Grip, Size, Sizes, point, within_a_turn
from camgeo.errors import GeometryError
from camgeo.mechanism.four_bar import FourBar
from camgeo.mechanism.linkage_protocol import Linkage
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.numeric.arrays import phase

PARALLEL = 1e-6
"""Largest tilt [rad] of a coupler that counts as parallel to the guide, as its dimensions want."""

ACROSS = "must stay on its side of the shaft"


@singledispatch
def linkage_grips(linkage: Linkage, place: complex, outward: complex) -> Iterator[Grip]:
    """The grips of a linkage that takes hold of the follower at `place` [mm].

    `outward` is the direction of the follower's guide, 0 for a rocker. None unless they are
    registered for its class.
    """
    del linkage, place, outward
    yield from ()


@linkage_grips.register
def _(linkage: FourBar, place: complex, outward: complex) -> Iterator[Grip]:
    del outward
    seen_pin, seen_tip = (complex(each[0]) for each in linkage.joints(np.zeros(1)))
    shaft, pin, tip = place + linkage.shaft, place + seen_pin, place + seen_tip

    def crank(to: complex) -> Sizes:
        side = (seen_pin.conjugate() * (to - place)).imag
        if side * linkage.branch >= 0.0:
            raise GeometryError(
                "must stay on its side of the line from the rocker shaft to the lever's pin",
                "linkage.branch",
            )
        return {"linkage.crank": Size(abs(to - place)), "linkage.coupler": Size(abs(pin - to))}

    def lever(to: complex) -> Sizes:
        angle = within_a_turn(linkage.lever_angle + phase((to - shaft) / (pin - shaft)))
        length = abs(to - shaft)
        return {"linkage.lever": Size(length), "linkage.lever_angle": Size(angle, length)}

    yield Grip("crank", "joint", tip, "xy", crank)
    yield Grip("lever", "joint", pin, "xy", lever)
    yield Grip("shaft", "pivot", shaft, "xy", lambda to: {"linkage.shaft": point(to - place)})


@linkage_grips.register
def _(linkage: SliderCrank, place: complex, outward: complex) -> Iterator[Grip]:
    del outward
    if linkage.coupler_tilt > PARALLEL:
        return
    pin, tip = (place + complex(each[0]) for each in linkage.joints(np.zeros(1)))
    yield Grip("crank", "joint", tip, "xy", lambda to: _crank(linkage, to - place))
    yield Grip("slider", "joint", pin, "x", lambda to: _coupler((to - tip).real, (pin - tip).real))


@linkage_grips.register
def _(linkage: SliderDrivenCrank, place: complex, outward: complex) -> Iterator[Grip]:
    inner = linkage.inner
    if inner.coupler_tilt > PARALLEL:
        return
    turn = outward * inner.slider_sense
    seen_pin, seen_tip = (complex(each[0]) for each in inner.joints(np.zeros(1)))
    shaft = place - turn * seen_pin

    def crank(to: complex) -> Sizes:
        # How far the pictured rod reaches along the guide depends on the stroke, and so on these.
        beside = ((to - place) * turn.conjugate()).imag
        return _crank(inner, complex(seen_tip.real, -beside))

    yield Grip("crank", "pivot", shaft, "radial", crank)


def _crank(linkage: SliderCrank, tip: complex) -> Sizes:
    """The crank of which the `tip` [mm] is seen from its shaft, with the guide above it."""
    if tip.imag <= 0.0:
        raise GeometryError(ACROSS, "linkage.crank_deflection")
    lean = linkage.slider_side if linkage.leans_away else -linkage.slider_side
    deflection = math.atan2(-lean * tip.real if linkage.mirrored else lean * tip.real, tip.imag)
    length = abs(tip)
    return {"linkage.crank": Size(length), "linkage.crank_deflection": Size(deflection, length)}


def _coupler(reach: float, before: float) -> Sizes:
    """The coupler that reaches that far along the guide [mm], on the side on which it did."""
    if reach * before <= 0.0:
        raise GeometryError("must stay on its side of the crank's tip", "linkage.coupler")
    return {"linkage.coupler": Size(abs(reach))}
