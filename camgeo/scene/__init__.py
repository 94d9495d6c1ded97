"""A scene: one TOML file with everything that determines a cam and its files.

`schema.json` is the one definition of its keys. `camgeo.scene.scene.enter` checks all values and
builds the objects of the lower rooms, or reports all faults at once, with file, line, key, value
and what is allowed.
"""
