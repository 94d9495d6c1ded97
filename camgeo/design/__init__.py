"""A design: a scene with its cams, the findings on them, and its discs as they are made.

`product` and its neighbours are a finished disc as each kind of file sees it; `writing` puts a set
of files in place, whole and certified; `verify` compares files of any origin with their scene.
"""
