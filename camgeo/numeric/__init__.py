"""Plain numerical tools that know nothing of cams: read-only arrays, bracketed roots."""
