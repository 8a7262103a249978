"""The STL monitor as a node of ROS 2."""
