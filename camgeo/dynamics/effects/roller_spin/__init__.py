"""Effect `roller-spin`: how the roller turns, and where it skids."""
