"""From a request to the files of a package: `spec`, then `render`, then `write`.

In: a name and options. Out: files, written all or none.
It imports `model`, `isolation` and `text`.
"""
