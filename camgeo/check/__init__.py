"""A cam compared with its limits: each answer is a `Finding` with value, limit and place.

`judge` asks everything; `cures` finds the nearest change that removes a fault, and `sizing` the
smallest cam without one.
"""
