/* The source of targets that are left out, which only make names known to CMake. */
