"""The cost of accuracy: pieces, bytes, computing and machining time over the tolerance."""
