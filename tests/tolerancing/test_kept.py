"""Whole analyses of each kind of machine with all its dimensions, and all that is refused."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from camgeo.app.answers import answer
from camgeo.app.answers.tolerance import tolerance
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.geometry.outline.path import Flank
from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.tolerancing.stated import NominalMachine, machine_dimensions
from tests import kept
from tests.thinned import WHOLE, share
from tests.tolerancing.machines import FIXTURES, LEVER

MACHINES: Final = ("inch", "flat_rocker", "tappet", "groove", "setzhub", "four_bar")

FIT: Final[dict[str, Any]] = {"hole": "H8", "shaft": "f7", "size": 1.5}

REFUSED: Final[tuple[dict[str, Any], ...]] = (
    {"tolerance": None},
    {"tolerance.dimension": [{"key": "follower.arms", "plus_minus": 1}]},
    {"tolerance.dimension": [{"key": "follower.offset", "plus_minus": 1}]},
    {"tolerance.dimension": [{"key": "mounting.x", "class": "h6"}]},
    {"tolerance.dimension": [{"key": "follower.arm", "class": "h99"}]},
    {"tolerance.dimension": [{"key": "follower.arm"}]},
    {"tolerance.dimension": [{"key": "follower.arm", "plus_minus": 1, "class": "h6"}]},
    {"tolerance.dimension": [{"key": "follower.arm", "plus_minus": 0}]},
    {"tolerance.dimension": [{"key": "follower.arm", "limits": [1, 0]}]},
    {"tolerance.dimension": [{"key": "follower.arm", "plus_minus": 1, "sigma": -1}]},
    {"tolerance.clearance": [{"at": "cam", "hole": "h7", "shaft": "g6"}]},
    {"tolerance.clearance": [{"at": "cam", "hole": "H7", "shaft": "G6"}]},
    {"tolerance.clearance": [{"at": "cam", "hole": "H7", "shaft": "k6"}]},
    {"tolerance.clearance": [{"at": "cam", "hole": "K7", "shaft": "h6"}]},
    {"tolerance.clearance": [{"at": "roller", "hole": "H7", "shaft": "g6"}]},
    {"tolerance.clearance": [{"at": "cam", "hole": "H7", "shaft": "g6"}], "part": None},
    {"tolerance.form": [{"plus_minus": 0.01, "waves": 1}]},
    {"tolerance.form": [{"plus_minus": 0.01, "waves": 100000}]},
    {"tolerance.limit": 0},
    {"tolerance.set_at": 361},
    {"tolerance.flank": "outer"},
)
"""Edits of a scene whose tolerances are right."""


def toleranced(scene: Scene) -> Scene:
    """With a tolerance of each dimension, in turns of each form, with fits and a form error."""
    cam = Design(scene).cam
    forms: tuple[dict[str, Any], ...] = (
        {"plus_minus": 0.01},
        {"limits": [-0.01, 0.03], "distribution": "uniform"},
        {"plus_minus": 0.02, "sigma": 0.005},
    )
    known = machine_dimensions(NominalMachine(cam, Flank(cam.contact.main)))
    dimensions = [
        {"key": key, **({"class": "h6"} if size.size and not number % 2 else forms[number % 3])}
        for number, (key, size) in enumerate(known.items())
    ]
    fits = [{"at": "cam", **FIT}, {"at": "cam", "shifted": "by-load", **FIT}]
    if not known.keys().isdisjoint({"follower.roller_radius"}):
        fits.append({"at": "roller", **FIT})
    table = {
        "dimension": dimensions, "clearance": fits, "limit": 0.5, "set_at": 30,
        "form": [{"plus_minus": 0.01, "waves": 7}],
    }  # fmt: skip
    return scene.with_values({"tolerance": table})


def test_analyses_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name in share(MACHINES, 3):
            found = tolerance(
                Design(toleranced(load_scene(FIXTURES / "scenes" / f"{name}.toml"))), count=0
            )
            yield name, kept.document(answer.to_json(found))
            yield f"{name}: table", kept.document(kept.summary(answer.table(found).values))

    kept.compare("tolerancing/analyses.txt", parts(), whole=WHOLE)


def test_what_is_refused_is_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        scene = load_scene(LEVER)
        for edits in REFUSED:
            try:
                tolerance(Design(scene.with_values(edits)), count=0)
                yield str(edits), "allowed"
            except CamgeoError as error:
                yield str(edits), str(error).replace(str(FIXTURES), "")

    kept.compare("tolerancing/refused.txt", parts())
