"""Many requirements, many recordings, many live streams.

==================  ====================================================================
module              purpose
==================  ====================================================================
fleet               ``Fleet``: an array of monitors by key: vehicles, machines, sessions
fleet_keys          the keys of a fleet: their number, monitors and removal
updates             what a batch has made known
keys                the keys and columns of a batch
opening             what a fleet has for its keys: records of the core, or monitors
per_key             a monitor for each key: dense time, and the other verdict modes
suite_per_key       a monitor for each key and each requirement of a suite
collectors          collects what these monitors report
reports             what they report, as arrays
late_data           batches of samples as they arrive, late ones among them
gaps                the policies for gaps between samples
fleet_snapshot      the bytes of a fleet with late data or gaps
monitors_snapshot   the bytes of a fleet with a monitor for each key
monitor_state       the state of one of these monitors
fields              the fields of a state as bytes
compiled            the program of a fleet, for the C API
suite               ``Suite``: many requirements compiled once into few programs
suite_requirements  their names, and what a report shows of them
groups              requirements that read a recording in the same way
suite_snapshot      the bytes of a suite: programs, and how recordings are read
verdict_table       robustness and verdicts, one row per recording and requirement
==================  ====================================================================
"""
