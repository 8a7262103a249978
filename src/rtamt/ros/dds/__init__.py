"""ROS 2 without ROS: the same wire, spoken by Cyclone DDS alone.

===========  ===========================================================================
module       what it holds
===========  ===========================================================================
types        message definitions to classes that Cyclone DDS can send
participant  topics under ROS 2's names, quality of service, the graph that ROS 2 shows
node         the monitor's node
===========  ===========================================================================
"""
