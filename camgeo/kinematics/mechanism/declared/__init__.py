"""The kinds of followers and linkages, each declared without what computes with it."""
