"""Python modules of packages that are not here and whose actions are known."""
