"""The smallest cure of undercut, one for each knob of the design, the cheapest first."""

from __future__ import annotations

from camgeo.check.cures.cure import Change, Cure
from camgeo.check.cures.margin import margin
from camgeo.check.cures.smallest import cures

__all__ = ["Change", "Cure", "cures", "margin"]
