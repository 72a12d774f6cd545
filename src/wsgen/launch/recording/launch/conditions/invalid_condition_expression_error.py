"""A condition that is neither true nor false."""


class InvalidConditionExpressionError(RuntimeError):
    """The text of a condition is none of true, 1, false, 0."""
