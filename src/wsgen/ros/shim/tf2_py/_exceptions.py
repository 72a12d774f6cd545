"""What tf2 raises (tf2_py/src/tf2_py.cpp of geometry2)."""


class TransformException(Exception):
    """Base of all."""


class ConnectivityException(TransformException):
    """Two frames are not in the same tree."""


class LookupException(TransformException):
    """A frame does not exist."""


class ExtrapolationException(TransformException):
    """The time is before or after what is known."""


class InvalidArgumentException(TransformException):
    """A name that cannot be one of a frame."""


class TimeoutException(TransformException):
    """A transform did not come in time."""
