"""Optimisation: the design of a family that is best in what is asked, within limits.

A `Task` says what is sought, a `Space` how designs become places in a box, `Trials` what was
computed; `optimise` searches and returns an `OptimisationResult`.
"""
