"""What was found out, in the forms that other programs read."""
