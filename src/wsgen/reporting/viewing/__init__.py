"""Robots in a browser: what is shown, the page that shows it, and files that are watched."""
