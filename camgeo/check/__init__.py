"""Checks: values of the design held against limits, each answered by a `Finding`."""
