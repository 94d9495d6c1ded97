"""What deviations cost in contact force."""

from __future__ import annotations

import numpy as np

from camgeo.answers.render import text
from camgeo.answers.tolerance import tolerance
from camgeo.design import Design
from camgeo.effects.results import CONTACT_FORCE
from camgeo.outline.path import Flank
from camgeo.scene.load import load_scene
from camgeo.tolerancing.contact import contact_forces
from tests.answers.documents import document
from tests.tolerancing.machines import ANGLES, LEVER


def test_force_per_acceleration_is_that_of_the_moving_mass() -> None:
    """At constant speed and mass the cam at rest lacks M q'' omega^2 / B, and nothing else."""
    design = Design(load_scene(LEVER))
    found = contact_forces(design, Flank.INNER, ANGLES)
    assert found is not None
    force = design.effects.result(CONTACT_FORCE)
    at_rest = force.normal_at(ANGLES, "right", np.zeros((2, len(ANGLES))))
    second = design.drive.motion.jet(ANGLES)[2]
    moving = found.per_acceleration * second
    np.testing.assert_allclose(found.nominal - at_rest, moving, rtol=0, atol=1e-9)
    assert np.ptp(moving) > 1.0  # N
    assert not found.per_velocity.any()
    lower = found.of(np.zeros((2, 1)), np.array([[0.0], [-0.01]]))
    np.testing.assert_allclose(lower[0], found.nominal)
    assert np.all(lower[1] < lower[0])


def test_the_cost_is_told_where_the_scene_asks_for_it() -> None:
    answer = tolerance(Design(load_scene(LEVER)), count=128)
    machines = document(answer)["machines"]
    for name in ("largest_force", "smallest_force"):
        low, middle, high = machines[name]["machines"]
        assert low <= middle <= high
        assert f"{middle:.5g}" in text(answer)
    assert machines["smallest_force"]["nominal"] < machines["largest_force"]["nominal"]


def test_no_effect_is_computed_that_is_not_named() -> None:
    design = Design(load_scene(LEVER).with_values({"effects.contact-force": None}))
    answer = tolerance(design, count=128)
    assert "largest_force" not in document(answer)["machines"]
    assert "contact force" not in text(answer)
    assert not any("inertia" in run.name for run in design.ledger.runs)
