"""Texts and files: TOML, YAML, XML, Python trees; what is printed; names that were meant.

In: paths and texts of anybody. Out: values with lines; files written whole or not at all.
It imports nothing of wsgen but its errors.
"""
