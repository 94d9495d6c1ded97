"""Interpreters of others as judges of ours: where one is installed, it runs our programs too.

`python -m tests.judges` runs all that are there and prints a table of them; `--all` fails if one is
absent. Nothing of them is kept here: each is found where it is installed, or by a variable.
"""
