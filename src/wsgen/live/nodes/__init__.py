"""What runs as a process of ROS; the only place that imports rclpy.

Each program is a module that is started with `python -m`, in the environment that
`wsgen.ros.environment` describes.
"""

import signal
import sys

if sys.argv[:1] == [
    "-m"
]:  # such a program starts: Ctrl-C ends it without a traceback of its imports
    signal.signal(signal.SIGINT, signal.SIG_DFL)
