"""Figures: whole commands in CPU time, as ratios against doing the same by hand."""
