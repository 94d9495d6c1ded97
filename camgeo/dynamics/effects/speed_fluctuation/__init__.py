"""Effect `speed-fluctuation`: speed of a motor-driven cam over a turn in its steady state."""
