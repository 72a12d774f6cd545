"""What lies on the path of nodes alone is on that of these tests, too."""

import sys
from pathlib import Path

SHIM = Path(__file__).parents[2] / "src" / "wsgen" / "ros_shim"

if str(SHIM) not in sys.path:
    sys.path.append(str(SHIM))
