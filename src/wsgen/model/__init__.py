"""What things are: frozen value classes without I/O and without third-party imports."""
