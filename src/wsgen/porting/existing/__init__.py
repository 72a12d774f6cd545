"""A robot that already exists becomes a package: `wsgen new --from`.

In: a description from elsewhere, as a file, folder or archive. Out: the URDF of the same robot with
the meshes that it names (`description.py`), and what of its source a URDF cannot say.
"""
