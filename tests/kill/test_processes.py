"""Processes that write sets are stopped at every step; `python -m tests.kill` does it at random."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from tests.kill.everywhere import BUILDS, BUILT
from tests.kill.signals import SIGNALS
from tests.long_form import LONG


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")
def test_stopped_at_every_step() -> None:
    """Forked where nothing but the test runs: a process with threads should not be."""
    command = [sys.executable, "-m", "tests.kill.everywhere"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"{run.stdout}\n{run.stderr}"
    told = json.loads(run.stdout)
    steps = told["alone, SIGKILL"]
    assert steps > 40
    caught = [told[f"alone, {number.name}"] for number in SIGNALS[1:]]
    assert caught == [steps] * 3 if LONG else sum(caught) == steps
    for number in SIGNALS:
        assert told[f"beside, {number.name}"] > (20 if LONG else 5)
    assert [told[f"builds, {number.name}"] for number in BUILT] == [BUILDS] * len(BUILT)
