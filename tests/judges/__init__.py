"""Programs of others as judges of ours: where one is installed, it reads our files too.

`python -m tests.judges` runs all that are there on six scenes and prints a table of them; `--all`
takes all scenes, and fails if a judge is absent. Nothing of them is kept here: each is found where
it is installed, or by a variable.
"""
