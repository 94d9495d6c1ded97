"""The slider-crank by the circles that cross in its crank tip, for series of the stroke."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.errors import GeometryError
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.stability.high_precision import Number, multiprecision
from camgeo.stability.series import Series, logarithm, root


@dataclass(frozen=True, slots=True)
class ExactSliderCrank:
    """A slider-crank with exact lengths and angle, and the assembly of `SliderCrank`."""

    crank: Number
    coupler: Number
    deflection: Number
    assembly: SliderCrank

    def swing(self, stroke: Series) -> Series:
        """psi [rad] from stroke 0, counter-clockwise positive, in (-pi, pi].

        Raises
        ------
        GeometryError
            If crank and coupler do not reach the pin, or lie on one line.
        """
        mp = multiprecision()
        start = self.crank_angle(Series((mp.mpf(0),)))
        psi = self.crank_angle(stroke) - start.terms[0]
        psi = psi - 2 * mp.pi * mp.ceil((psi.terms[0] - mp.pi) / (2 * mp.pi))
        turned: Series = -psi if self.assembly.mirrored else psi
        return turned

    def crank_angle(self, stroke: Series) -> Series:
        """theta [rad]: the pin's angle less that of the triangle of shaft, tip and pin.

        By the law of cosines; raises as `swing` does.
        """
        mp = multiprecision()
        crank, coupler, how = self.crank, self.coupler, self.assembly
        lean = crank * mp.sin(self.deflection)
        start = how.slider_side * (coupler - lean if how.leans_away else coupler + lean)
        height = crank * mp.cos(self.deflection)
        pin = -(start + how.stroke_direction * stroke) + mp.mpc(0, 1) * height
        square = pin.real**2 + height**2
        opposite = (square + (crank**2 - coupler**2)) / (2 * crank * root(square))
        across = 1 - opposite**2
        if not across.terms[0] > 0 and (len(stroke.terms) > 1 or across.terms[0] < 0):
            raise GeometryError("crank and coupler do not reach the pin", key="linkage")
        between = logarithm(opposite + mp.mpc(0, 1) * root(across)).imag
        # Counted from straight above the shaft: a pin on the guide through the shaft stays off the
        # cut of the logarithm whichever way half an ulp moves it.
        upward = logarithm(pin * mp.mpc(0, -1)).imag
        angle: Series = upward + mp.pi / 2 - how.branch * between
        return angle
