"""Families of scenes: one scene with other values at some keys, and what is asked of each design.

A `Family` states which designs there are, each `Question` what is computed of them, and an `Engine`
where. Rows are kept in a `Store`, with which a run that was stopped continues.
"""
