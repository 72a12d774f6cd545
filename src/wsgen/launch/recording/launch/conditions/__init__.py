"""All conditions."""

from launch._lazy import finder

_HOMES = {
    "IfCondition": "if_condition",
    "InvalidConditionExpressionError": "invalid_condition_expression_error",
    "LaunchConfigurationEquals": "launch_configuration_equals",
    "LaunchConfigurationNotEquals": "launch_configuration_not_equals",
    "UnlessCondition": "unless_condition",
    "evaluate_condition_expression": "evaluate_condition_expression_impl",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
