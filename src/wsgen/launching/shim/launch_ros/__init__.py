"""Shim of the `launch_ros` package."""

from launch._finder import ON_DEMAND, names_on_demand

__getattr__ = names_on_demand(__name__)
__all__ = list(ON_DEMAND[__name__])
