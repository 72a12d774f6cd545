"""Rules about robots and simulation runs, and the catalogue of all rules."""
