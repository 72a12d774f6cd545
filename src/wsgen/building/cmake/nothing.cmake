# What include(${..._USE_FILE}) includes of a package that is not installed.
