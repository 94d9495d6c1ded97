"""The smallest cures of undercut, one for each knob of the design, cheapest first."""
