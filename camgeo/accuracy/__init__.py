"""What accuracy costs: pieces, bytes, computing and machining time over the tolerance."""
