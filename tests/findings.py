"""The findings of a design's effects together."""

from __future__ import annotations

from camgeo.check.finding import Finding
from camgeo.design.design import Design


def effect_findings(design: Design) -> tuple[Finding, ...]:
    """Findings of the effects in the scene, in its order; those that several effects share once."""
    found = [each for name in design.scene.effects for each in design.effects.findings(name)]
    return tuple(dict.fromkeys(found))
