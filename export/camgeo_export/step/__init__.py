"""The STEP writer; the reader, `camgeo_export.part21`, shares no code with it."""
