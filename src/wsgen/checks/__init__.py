"""Rules over facts: one small function a rule, and the catalogue of all codes."""
