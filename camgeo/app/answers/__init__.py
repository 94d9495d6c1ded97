"""What the commands take and find: options, frozen results, and their renderings."""
