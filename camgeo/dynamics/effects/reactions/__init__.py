"""Effect `reactions`: forces in the bearings of follower and camshaft."""
