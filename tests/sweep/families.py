"""Small families, and scenes to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.sweep.family import Family, family_of

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

SETZHUB: Final = load_scene(FIXTURES / "scenes" / "setzhub.toml")

RADII: Final = "follower.base_radius=45:60:4"

LAWS: Final = "motion.2.law=modified-sine,polynomial-345"


def family(*vary: str, scene: Scene = SETZHUB) -> Family:
    """All combinations of what varies."""
    return family_of(scene, vary or (RADII, LAWS))
