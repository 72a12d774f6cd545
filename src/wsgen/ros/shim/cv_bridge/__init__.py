"""`cv_bridge` for nodes where it is not installed: images as arrays and back, without OpenCV."""

from cv_bridge.core import CvBridge, CvBridgeError

__all__ = ["CvBridge", "CvBridgeError"]
