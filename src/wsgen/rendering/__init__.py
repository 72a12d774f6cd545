"""Pictures and videos of what is simulated."""
