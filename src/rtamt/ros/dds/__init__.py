"""ROS 2 nodes without a ROS installation: the ROS 2 wire protocol on Cyclone DDS alone.

===========  ===========================================================================
module       purpose
===========  ===========================================================================
types        message definitions to classes for Cyclone DDS
participant  topics under ROS 2's names, quality of service, the ROS 2 graph
node         the monitor's node
===========  ===========================================================================
"""
