"""Effect `vibration`: an elastic follower train in its steady state."""
