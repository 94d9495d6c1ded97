"""What a scene states of many designs, or of many machines for one."""

from __future__ import annotations

from random import Random
from typing import Any, Final

from camgeo.kinematics.laws import FAMILIES


def family(rng: Random, radius: float) -> dict[str, Any]:
    """A few designs, and what is asked of them."""
    variables: list[dict[str, Any]] = [
        {"key": "follower.base_radius", "from": radius, "to": 1.2 * radius, "count": 2},
        {"key": "motion[1].law", "values": rng.sample(sorted(FAMILIES), 2)},
        {"keys": ["cam.speed", "limits.diameter"], "values": [[10, 20 * radius], [1e5, 1]]},
        {"key": "cam.rotation", "values": ["cw", "ccw"]},
    ]
    asked = ("transmission-angle", "peak:s'", "min:kappa", "verdict", "diameter", "closure")
    found: dict[str, Any] = {
        "vary": rng.sample(variables, rng.randint(1, 2)),
        "ask": rng.sample(asked, rng.randint(1, 3)),
    }
    if rng.random() < 0.3:
        found |= {"samples": rng.randint(1, 4), "method": rng.choice(("sobol", "random"))}
    return found


DISTRIBUTIONS: Final = ("normal", "uniform", "triangular")


def tolerances(rng: Random, radius: float, values: dict[str, Any]) -> dict[str, Any]:
    """Tolerances of usual size, at times of any, of dimensions that the machine may have."""

    def size() -> float:
        return float(f"{radius * 10.0 ** rng.choice((-4.0, -4.0, -3.0, rng.uniform(-12, 0))):.3g}")

    def dimension(key: str) -> dict[str, Any]:
        found: dict[str, Any] = {"key": key}
        match rng.choice(("plus_minus", "plus_minus", "limits", "class")):
            case "plus_minus":
                found["plus_minus"] = size()
            case "limits":
                found["limits"] = sorted((size(), rng.choice((-1.0, 1.0)) * size()))
            case _:
                found["class"] = rng.choice(("h6", "H7", "js9", "g6"))
        if rng.random() < 0.3:
            found["distribution"] = rng.choice(DISTRIBUTIONS)
        return found

    others = ("mounting.x", "mounting.angle", "shaft.y", "follower.pivot[2]", "linkage.crank")
    numbers = [key for key, value in values["follower"].items() if isinstance(value, float | int)]
    known = [*(f"follower.{key}" for key in numbers), *others]
    found: dict[str, Any] = {
        "dimension": [dimension(key) for key in rng.sample(known, rng.randint(1, 3))]
    }
    if rng.random() < 0.5:
        found["limit"] = size()
    if rng.random() < 0.2:
        found["set_at"] = rng.choice((0, 123.4, 360))
    if rng.random() < 0.3:
        found["form"] = [{"plus_minus": size(), "waves": rng.choice((1, 12, 1000))}]
    if rng.random() < 0.3:
        fit = {"size": 20, "hole": "H7", "shaft": rng.choice(("g6", "h6", "p6"))}
        found["clearance"] = [{"at": rng.choice(("cam", "roller")), **fit}]
        if rng.random() < 0.5:
            found["clearance"][0]["shifted"] = "by-load"
    return found
