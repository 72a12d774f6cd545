"""Rules about robots, runs and packages, and the safe fixes of what they report.

In: what readers give: values of `model`, facts of build files, plans. Out: diagnostics, edits.
It imports `simulation`, `building` and what is below them; `pipeline` calls it.
"""
