"""Measured points on a real disc compared with its exact flank, and points to be measured."""
