"""`[print]` in scenes: converted, compared with the part, and in the hashes only where it is."""

from __future__ import annotations

from typing import Any

import pytest

from camgeo.errors import SceneError
from camgeo.part.printing import Foot, PrintSpec, Shrinkage
from camgeo.scene.scene import Scene, load_scene
from tests.contour.cams import SCENES

WHOLE = {
    "print.bore_clearance": 0.2,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4, "steps": 2},
    "print.shrinkage": {"xy": 0.5},
}


@pytest.fixture(scope="module")
def plate() -> Scene:
    return load_scene(SCENES / "plate_translating.toml").with_values({"part.bore": 20})


def test_a_scene_without_it_prints_as_it_is(plate: Scene) -> None:
    assert plate.printing is None


def test_the_table_is_converted(plate: Scene) -> None:
    found = plate.with_values(WHOLE).printing
    assert found == PrintSpec(0.2, None, Foot(0.2, 0.4, 2), Shrinkage(0.5, 0.0))
    inches = load_scene(SCENES / "inch.toml").with_values({**WHOLE, "print.bore_clearance": 0.01})
    assert inches.printing is not None
    assert inches.printing.bore_clearance == pytest.approx(0.254)
    assert inches.printing.elephant_foot == Foot(0.2 * 25.4, 0.4 * 25.4, 2)
    assert inches.printing.scale_xy == pytest.approx(1.0 / 0.995)


def test_a_foot_higher_than_a_thin_disc_on_a_hub(plate: Scene) -> None:
    """The hub lies on the bed, not the disc."""
    hub = {"diameter": 34, "height": 6, "side": "lower"}
    foot = {"inset": 0.2, "height": 4}
    values = {"part.thickness": 3, "part.hub": hub, "print.elephant_foot": foot}
    assert plate.with_values(values).printing == PrintSpec(elephant_foot=Foot(0.2, 4.0))


def test_it_decides_the_bytes_of_files(plate: Scene) -> None:
    assert len({plate.made, *(plate.with_values({k: v}).made for k, v in WHOLE.items())}) == 4


@pytest.mark.parametrize(
    ("values", "key", "message"),
    [
        (
            {"part.keyway": None, "print.key_clearance": 0.1},
            "print.key_clearance",
            "needs .part. keyway, or d_shaft",
        ),
        (
            {"part.bore": None, "part.keyway": None, "print.bore_clearance": 0.1},
            "print.bore_clearance",
            "needs .part. bore",
        ),
        (
            {"print.elephant_foot": {"inset": 0.1, "height": 50}},
            "print.elephant_foot.height",
            "must be less than the thickness",
        ),
        (
            {
                "part.hub": {"diameter": 34, "height": 3, "side": "lower"},
                "print.elephant_foot": {"inset": 0.1, "height": 4},
            },
            "print.elephant_foot.height",
            "must be less than the height of the lower hub, 3",
        ),
        ({"print.elephant_foot": {"inset": 0.1}}, "print.elephant_foot.height", "is missing"),
        ({"print.elephant_foot": 0.2}, "print.elephant_foot", "must be a table, e.g."),
        ({"print.bore_clearance": 0}, "print.bore_clearance", "must be a positive number"),
        ({"print.shrinkage": {"xy": 25}}, "print.shrinkage.xy", "must be a number from -10 to 20"),
        ({"part.print_clearance": 0.2}, "part.print_clearance", "is not a known key"),
        ({"print.clearance": 0.2}, "print.clearance", "did you mean"),
    ],
)
def test_refusals(plate: Scene, values: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as caught:
        plate.with_values(values)
    assert [fault.key for fault in caught.value.faults] == [key]
