"""All substitutions."""

from launch._lazy import finder

_HOMES = {
    "AndSubstitution": "boolean_substitution",
    "AnonName": "anon_name",
    "AnySubstitution": "boolean_substitution",
    "AllSubstitution": "boolean_substitution",
    "BooleanSubstitution": "boolean_substitution",
    "Command": "command",
    "EnvironmentVariable": "environment_variable",
    "EqualsSubstitution": "equals_substitution",
    "FileContent": "file_content",
    "FindExecutable": "find_executable",
    "ForEachVar": "for_loop_var",
    "ForLoopIndex": "for_loop_var",
    "IfElseSubstitution": "if_else_substitution",
    "LaunchConfiguration": "launch_configuration",
    "LaunchLogDir": "launch_log_dir",
    "LocalSubstitution": "local_substitution",
    "NotEqualsSubstitution": "not_equals_substitution",
    "NotSubstitution": "boolean_substitution",
    "OrSubstitution": "boolean_substitution",
    "PathJoinSubstitution": "path_join_substitution",
    "PathSubstitution": "path_join_substitution",
    "PythonExpression": "python_expression",
    "SubstitutionFailure": "substitution_failure",
    "TextSubstitution": "text_substitution",
    "ThisLaunchFile": "this_launch_file",
    "ThisLaunchFileDir": "this_launch_file_dir",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
