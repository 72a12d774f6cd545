"""What child processes do: the functions that `wsgen.isolation` calls by name.

Each brings together packages that do not import each other.
"""
