"""Effect `contact-force`: the force between cam and follower along their common normal."""
