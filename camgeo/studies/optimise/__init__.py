"""Optimisation: the best design of a family for given objectives, within limits.

A `Task` states the objectives and what varies, a `Space` represents designs as places in a box, and
`Trials` are the designs computed; `optimise` searches and returns an `OptimisationResult`.
"""
