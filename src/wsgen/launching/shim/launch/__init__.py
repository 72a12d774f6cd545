"""Shim of the `launch` package: evaluates launch files, starts nothing."""

import sys

from ._finder import ON_DEMAND, Finder, names_on_demand

__getattr__ = names_on_demand(__name__)
__all__ = list(ON_DEMAND[__name__])

if Finder not in sys.meta_path:
    sys.meta_path.insert(0, Finder)
