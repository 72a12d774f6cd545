"""Helpers for nodes."""
