"""The stages that take a package or a file from its name to its result."""
