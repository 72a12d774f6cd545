"""Something is added to a package of anybody: a node, a message, a launch file, a sensor.

In: a package and what is wanted. Out: new files, and edits that only insert, where the author would
have put them; what cannot be placed is to be pasted. Nothing is written before all of it is known.
"""
