"""Reader of STEP files (ISO 10303-21) and of the upright solids in them, whoever wrote them.

It shares no code with the writer, `camgeo_export.step`.
"""
