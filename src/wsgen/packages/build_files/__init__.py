"""CMakeLists.txt, setup.py and setup.cfg, read without running them."""
