"""From a request to the files of a package: `spec`, then `render`, then `write`."""
