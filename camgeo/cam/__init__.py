"""A cam: the drive that moves it, the disc that turns, and the follower on its flanks.

All later rooms hold a `Cam` and query it; none reassembles motion, curve and flanks.
"""
