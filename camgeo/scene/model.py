"""What `[output]` says, converted to millimetres."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from camgeo.formats.format import Options

if TYPE_CHECKING:
    from camgeo.contour.contour import Effort


@dataclass(frozen=True, slots=True)
class OutputSpec:
    """`[output]`: what is written, and how exactly.

    Attributes
    ----------
    formats : names of the writers, in the order of the scene.
    tolerance : largest deviation of any written contour from the exact curve [mm].
    fit : how hard fits try, see `camgeo.contour.contour.Effort`.
    options : of the formats, see `camgeo.formats.format.Options`.
    accuracy_ripple : whether what accuracy costs shows the ripple of the acceleration too.
    """

    formats: tuple[str, ...] = ("dxf",)
    tolerance: float = 0.001
    fit: Effort = "fewest"
    options: Options = field(default_factory=Options)
    accuracy_ripple: bool = False
