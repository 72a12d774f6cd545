"""Shims of the Python modules of packages whose actions are known.

Those packages have no `__init__.py`, and so any that is installed comes before them, wherever it
stands on the path.
"""
