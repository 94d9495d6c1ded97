"""Strategies of milling: each makes the moves of a cut, and is registered in `registry`."""
