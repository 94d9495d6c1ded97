"""Vibration of an elastic train whose base moves in smooth pieces, solved exactly."""
