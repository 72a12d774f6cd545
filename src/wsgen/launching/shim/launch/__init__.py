"""Shim of the `launch` package: evaluates launch files, starts nothing."""

import sys

from ._finder import Finder, names_on_demand

_HOMES = {
    "Action": "base",
    "Condition": "base",
    "Event": "base",
    "EventHandler": "base",
    "InvalidLaunchFileError": "base",
    "LaunchContext": "launch_context",
    "LaunchDescription": "launch_description",
    "LaunchService": "launch_description",
    "LaunchDescriptionEntity": "base",
    "LaunchDescriptionSource": "launch_description",
    "SomeActionsType": "base",
    "SomeEntitiesType": "base",
    "SomeSubstitutionsType": "base",
    "SomeSubstitutionsType_types_tuple": "base",
    "Substitution": "base",
    "actions": "",
    "conditions": "",
    "event_handlers": "",
    "frontend": "",
    "events": "",
    "launch_description_sources": "",
    "logging": "",
    "substitutions": "",
    "utilities": "",
}
__all__ = list(_HOMES)
__getattr__ = names_on_demand(__name__, _HOMES)

if Finder not in sys.meta_path:
    sys.meta_path.insert(0, Finder)
