"""What things are: frozen value classes without I/O and without third-party imports.

In and out: nothing. Robots, worlds, plans, outcomes are defined here for all others.
It imports `diagnostics` and `text.values`.
"""
