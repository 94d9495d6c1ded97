"""Effect `spring-surge`: waves in a helical spring that harmonics of the lift excite."""
