"""Effect `lift-off`: where the follower leaves its flank, and what prevents it."""
