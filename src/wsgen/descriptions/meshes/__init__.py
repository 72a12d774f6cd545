"""Mesh files: find, read, inspect and convert them; make meshes of shapes that no engine has."""
