"""A substitution that has no text."""


class SubstitutionFailure(RuntimeError):  # noqa: N818  the name is the original's
    """Performing a substitution failed."""
