"""Run functions in child processes that may crash, hang or eat memory.

Launch files, xacro expressions and physics engines are foreign code: they run in a child, and the
child's death is a value, never the death of wsgen. `parent.run` starts an interpreter for one
child, `fork_server.ForkServer` forks many from one; `child` is what runs in them.
"""
