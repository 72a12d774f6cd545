"""xacro files: expand them in a child process and explain what is wrong with them."""
