"""Run colcon on a workspace and explain why a build fails; what colcon loads of wsgen.

In: a workspace, names of packages. Out: an install space, diagnostics about what fails.
It imports `packages` and what is below them; no simulation.
"""
