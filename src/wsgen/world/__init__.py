"""SDF worlds: read them, and find what they include."""
