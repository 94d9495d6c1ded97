"""Files: what writers get to see, the registry of writers, and writing whole sets or nothing."""
