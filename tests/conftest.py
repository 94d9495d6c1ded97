"""How hypothesis draws: the same examples in every run, others with `--hypothesis-profile=random`.

A reader who runs the tests is told of faults of the code, not of a rare example that no one else
can see again; whoever hunts for such examples asks for them.
"""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile("random", derandomize=False, deadline=None, print_blob=True)
settings.load_profile("fixed")
