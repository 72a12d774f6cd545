"""Recording stand-in for the `launch` package: evaluates launch files, starts nothing."""

from ._lazy import finder

_HOMES = {
    "Action": "action",
    "Condition": "condition",
    "Event": "event",
    "EventHandler": "event_handler",
    "InvalidLaunchFileError": "invalid_launch_file_error",
    "LaunchContext": "launch_context",
    "LaunchDescription": "launch_description",
    "LaunchService": "launch_service",
    "LaunchDescriptionEntity": "launch_description_entity",
    "LaunchDescriptionSource": "launch_description_source",
    "SomeActionsType": "some_actions_type",
    "SomeEntitiesType": "some_entities_type",
    "SomeSubstitutionsType": "some_substitutions_type",
    "SomeSubstitutionsType_types_tuple": "some_substitutions_type",
    "Substitution": "substitution",
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
__getattr__ = finder(__name__, _HOMES)
