"""All actions."""

from launch._lazy import finder

_HOMES = {
    "AppendEnvironmentVariable": "append_environment_variable",
    "DeclareLaunchArgument": "declare_launch_argument",
    "EmitEvent": "emit_event",
    "ExecuteLocal": "execute_local",
    "ExecuteProcess": "execute_process",
    "ForEach": "for_loop",
    "ForLoop": "for_loop",
    "GroupAction": "group_action",
    "IncludeLaunchDescription": "include_launch_description",
    "Log": "log_info",
    "LogDebug": "log_info",
    "LogError": "log_info",
    "LogInfo": "log_info",
    "LogWarning": "log_info",
    "OpaqueCoroutine": "opaque_coroutine",
    "OpaqueFunction": "opaque_function",
    "PopEnvironment": "pop_environment",
    "PopLaunchConfigurations": "pop_launch_configurations",
    "PushEnvironment": "push_environment",
    "PushLaunchConfigurations": "push_launch_configurations",
    "RegisterEventHandler": "register_event_handler",
    "ResetEnvironment": "reset_environment",
    "ResetLaunchConfigurations": "reset_launch_configurations",
    "SetEnvironmentVariable": "set_environment_variable",
    "SetLaunchConfiguration": "set_launch_configuration",
    "Shutdown": "shutdown_action",
    "TimerAction": "timer_action",
    "UnregisterEventHandler": "unregister_event_handler",
    "UnsetEnvironmentVariable": "unset_environment_variable",
    "UnsetLaunchConfiguration": "unset_launch_configuration",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
