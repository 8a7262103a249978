"""Determine whether a requirement holds, and when it is first violated.

Everything that decides about a requirement is here: specifications, results, searches, nodes and commands use it.

====================  =============================================================================
module                purpose
====================  =============================================================================
robustness_and_truth  the two outputs of a requirement: robustness and Boolean truth
decompose             split a formula into windows that start at the first sample
trackers              the value and the first violation of a formula that was split
prepared              many requirements as programs: robustness, truth and first violation
preparation           compile many requirements to such programs
offline               first violations in a finished trace
streaming             ``check_stream``: check a recording in chunks with bounded memory
discrete_stream       the chunks of a recording in discrete time
dense_stream          the chunks of a recording in dense time
chunks                requirements over chunks: what a monitor computes for them, and their results
modes                 the list of verdict modes of a monitor
early                 monitors before the horizon: eager verdicts, interval bounds, causation
standalone            compile a requirement to a program that runs without Python
====================  =============================================================================
"""
