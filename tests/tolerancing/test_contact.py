"""What deviations cost in contact force."""

from __future__ import annotations

import numpy as np

from camgeo.app.answers.answer import text
from camgeo.app.answers.tolerance import tolerance
from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.geometry.outline.path import Flank
from camgeo.scene.scene import load_scene
from camgeo.studies.tolerancing.linear import contact_forces, replay_machines
from camgeo.studies.tolerancing.stated import Deviations, machine_dimensions
from tests.answers.documents import document
from tests.findings import known
from tests.tolerancing.machines import ANGLES, LEVER, sensitivities


def test_force_per_acceleration_is_that_of_the_moving_mass() -> None:
    """At constant speed and mass the cam at rest lacks M q'' omega^2 / B, and nothing else."""
    design = Design(load_scene(LEVER))
    found = known(contact_forces(design, Flank.INNER, ANGLES))
    force = design.effects.result(CONTACT_FORCE)
    at_rest = force.normal_at_rates(ANGLES, "right", np.zeros((2, len(ANGLES))))
    second = design.drive.motion.jet(ANGLES)[2]
    moving = found.per_acceleration * second
    np.testing.assert_allclose(found.nominal - at_rest, moving, rtol=0, atol=1e-9)
    assert np.ptp(moving) > 1.0  # N
    assert not found.per_velocity.any()


def test_a_disc_that_runs_ahead_has_the_same_forces_earlier() -> None:
    """But for the spring, which gives way by the error and is left out: a tenth of the change."""
    design, turned = Design(load_scene(LEVER)), 1e-3
    nominal = sensitivities(design.scene)
    found = known(contact_forces(design, Flank.INNER, ANGLES))
    unit = machine_dimensions(nominal.machine)["mounting.angle"].unit
    machines = replay_machines(nominal, Deviations(1, {unit.freedom: np.full(1, turned + 0j)}))
    off = machines.follower - nominal.lifts[:3, np.newaxis]
    (normal,) = found.machine_forces(off, machines.leverage)
    exact = design.effects.result(CONTACT_FORCE).normal(ANGLES + turned, "right")
    change = float(np.max(np.abs(exact - found.nominal)))
    assert float(np.max(np.abs(normal - exact))) <= 0.1 * change


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
