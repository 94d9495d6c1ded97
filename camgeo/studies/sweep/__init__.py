"""Families of scenes: one scene with other values at some keys, and what is asked of each design.

A `Family` says which designs there are, `Question`s what is computed of each, an
`Engine` where. Rows go into a `Store`, from which a run that was stopped goes on.
"""
