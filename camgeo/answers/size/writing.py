"""The scene with the sizes that were found, and what has to change with them."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal
from typing import Any, Final

from camgeo.cam.cam import Cam
from camgeo.check.sizing.rounding import Made, exponent_of
from camgeo.check.sizing.smallest import SIDES
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER

OTHER_WAY: Final = {"outward": "inward", "inward": "outward"}


def scene_with(scene: Scene, made: Made) -> Scene:
    """The scene with the sizes of `made`; SceneError if it would not be valid."""
    return scene.with_values(edits_with(scene, made))


def edits_with(scene: Scene, made: Made) -> dict[str, Any]:
    """The values, by key, that the scene has with the sizes of `made`, which are in its unit.

    A rocker on the other side of its arm is moved the other way by the same linkage. A yoke is
    widened or narrowed by as much as both of its sides move. A return disc on a carriage
    stays as it is, because its roller does; a return arm stays on its side of the main arm.
    """
    edits: dict[str, Any] = {f"follower.{key}": each for key, each in made.lengths.items()}
    before = scene.follower
    assert before is not None  # it was sized
    side, was = (getattr(each, "arm_side", None) for each in (made.cam.follower, before))
    if side is not None and side != was:
        edits["follower.arm_side"] = SIDES[side]
        if scene.linkage is not None and scene.stated.has("follower", "direction"):
            edits["follower.direction"] = OTHER_WAY[scene.stated.get("follower", "direction")]
        turned = scene.stated.exact("follower", "return", "arm_angle")
        if turned is not None:
            edits["follower.return.arm_angle"] = -float(turned)
    breadth = scene.stated.exact("follower", "yoke", "breadth")
    if breadth is not None:
        old = scene.stated.exact("follower", "base_radius") or Decimal(0)
        wider = 2 * (Decimal(repr(made.lengths["base_radius"])) - old)
        edits["follower.yoke.breadth"] = float(breadth + wider)
    if scene.stated.has("follower", "return", "spacing"):
        edits |= _return_roller(scene, made.cam)
    return edits


def _return_roller(scene: Scene, cam: Cam) -> dict[str, float]:
    """Spacing and offset of the return roller, in the scene's unit, that leave it where it is."""
    main: Any = cam.follower
    other: Any = scene.returning
    unit = MM_PER[scene.unit]

    def near(length: float) -> float:
        last = Decimal(1).scaleb(exponent_of(main.base_radius, unit))
        return float(Decimal(length / unit).quantize(last, ROUND_HALF_EVEN)) + 0.0

    edits = {"follower.return.spacing": near(main.start_height + other.start_height)}
    if not scene.stated.has("follower", "return", "offset"):
        edits["follower.return.offset"] = near(-other.offset)
    return edits
