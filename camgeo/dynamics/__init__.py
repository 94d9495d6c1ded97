"""Forces, speeds and vibrations: what a scene asks for beyond geometry, and nothing else.

`state` is the motion for which they are computed, `effects` has a folder for each effect, which
declares it without importing what computes it, and `oscillator` solves elastic trains.
"""
