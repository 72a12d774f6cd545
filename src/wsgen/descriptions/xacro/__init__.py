"""xacro files: expand them in a child process, and explain and place their errors."""
