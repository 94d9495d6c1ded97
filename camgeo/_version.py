"""The version, in the only place that everything else reads it from."""

__version__ = "0.1.0"
