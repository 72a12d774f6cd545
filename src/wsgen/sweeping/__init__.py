"""Many variants of a robot, simulated one by one: what varies, the runs, and their table.

In: a design. Out: rows, a summary, plots; `children`, `dask_cluster` say where runs are computed.
It imports `pipeline` and what is below it; nothing below imports it.
"""
