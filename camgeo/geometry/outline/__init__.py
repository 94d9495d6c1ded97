"""The remaining flank: cusps, undercut, the outline of the real disc, the follower on it."""
