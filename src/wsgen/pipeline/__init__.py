"""The stages that take a package or a file from its name to its result.

In: a request. Out: an outcome with its diagnostics, for `wsgen new`, `check`, `validate`, `view`.
It imports everything below it; `tasks` has what runs in a child and needs two siblings.
"""
