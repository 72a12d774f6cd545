"""Launch files in XML and YAML; imported only where one is met."""

from launch._finder import ON_DEMAND, names_on_demand

__getattr__ = names_on_demand(__name__)
__all__ = list(ON_DEMAND[__name__])
