"""Processes that write sets are stopped; `python -m tests.kill` does it more often."""

from __future__ import annotations

import os
import random
import subprocess
import sys

import pytest

from tests.long_form import examples


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")
def test_killed_at_random() -> None:
    """Other moments in each run; the seed is in the message."""
    seed = str(random.SystemRandom().randrange(10**6))
    command = [
        sys.executable,
        "-m",
        "tests.kill",
        "--count",
        examples("10", long="100"),
        "--seed",
        seed,
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0, f"{run.stdout}\n{run.stderr}"
