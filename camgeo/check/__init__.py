"""Checks: values of the design compared with limits, each answered by a `Finding`."""
