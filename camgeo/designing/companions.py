"""What goes with a choice: keys that it needs get initial values, keys that contradict it go.

Only choices have companions: another law, another flank to run on, another shape of a linkage.
Numbers are set as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Final

import numpy as np

from camgeo.design import KEPT
from camgeo.designing.given import Given
from camgeo.designing.segments import with_a_point
from camgeo.designing.snapping import is_number, rounded
from camgeo.errors import CamgeoError
from camgeo.scene.keys import Path, path_of, value_at
from camgeo.scene.tree import Tree, edited
from camgeo.units import MM_PER, TURN

CONTACT: Final = ("follower", "contact")

DIRECTION: Final = ("follower", "direction")
"""A key that a linkage determines."""

OF_CONTACT: Final = (
    ("part", "rim"), ("part", "groove_depth"), ("part", "bore"), ("part", "hub"),
    ("part", "keyway"), ("part", "d_shaft"), ("part", "set_screw"), ("part", "pair"),
    ("follower", "side_clearance"), ("follower", "return"), ("follower", "yoke"),
    ("limits", "closing_error"),
)  # fmt: skip
"""Keys that not every contact can have."""

SAMPLES: Final = 360
"""Points of the pitch curve from which a blank is estimated."""

BESIDE: Final = 1.6
"""How far a blank reaches beyond the roller's centre, in roller radii."""


def with_companions(given: Given, after: Tree, edits: Mapping[str, Any]) -> Tree:
    """The tree `after` these edits, with the companions of the choices among them."""
    paths = {path_of(key) or (): value for key, value in edits.items()}
    for path, value in paths.items():
        if not isinstance(value, str | bool):
            continue
        if path[:1] == ("motion",) and path[2:] == ("law",):
            after = _with_law(given, after, path)
        elif path == CONTACT:
            after = _with_contact(given, after)
        elif path[:1] == ("linkage",) and DIRECTION not in paths:
            after = given.without_misfits(after, lambda misfit: misfit == DIRECTION)
    return after


def _with_law(given: Given, after: Tree, path: Path) -> Tree:
    """Without the parameters that the law at `path` does not take; a motion through points gets its
    first point.
    """
    after = with_a_point(after, int(path[1]))
    own = value_at(after, path[:2])
    among = [(*path[:2], key) for key in own if key not in KEPT]
    return given.without_misfits(after, lambda misfit: misfit in among)


def _with_contact(given: Given, after: Tree) -> Tree:
    """With a blank around a groove or a ring, and a groove half as deep as the part is thick, and
    without the keys that a cam of that contact cannot have.
    """
    first: Tree | None = None
    for tree in _blanks(given, after):
        mended = given.without_misfits(tree, lambda misfit: misfit in OF_CONTACT)
        if not given.new_faults(mended):
            return mended
        first = first or mended
    return first or after


def _blanks(given: Given, after: Tree) -> Iterator[Tree]:
    edits: dict[str, Any] = {}
    if value_at(after, ("part", "rim")) is None:
        edits["part.rim"] = _diameter(given)
    thick = value_at(after, ("part", "thickness"))
    deep = dict(edits)
    if is_number(thick) and value_at(after, ("part", "groove_depth")) is None:
        deep["part.groove_depth"] = rounded(Decimal(thick) / 2)
    part = after.get("part", {})
    if isinstance(part, dict):
        yield edited(after, deep) if deep else after
        yield edited(after, edits) if edits else after
    yield after


def _diameter(given: Given) -> Any:
    """Diameter of a blank with room all around for the roller."""
    try:
        cam = given.design.cam
        phi = np.linspace(0.0, TURN, SAMPLES, endpoint=False)
        reach = float(np.max(np.abs(cam.disc.pitch_curve.point(phi))))
        reach += BESIDE * cam.follower.roller_radius
        return rounded(Decimal(2.0 * reach / MM_PER[given.design.scene.unit]))
    except CamgeoError:  # no design as yet
        return 200
