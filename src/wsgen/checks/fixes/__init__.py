"""Safe fixes: what changes a file of the user so that a rule has no reason to report it again."""
