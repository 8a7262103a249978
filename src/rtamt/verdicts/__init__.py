"""Determine whether a requirement holds, and when it is first violated.

Everything that decides about a requirement is here: specifications, results, searches, nodes and commands use it.

====================  =================================================================
module                purpose
====================  =================================================================
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
early                 what all monitors of verdicts and bounds before the horizon share
discrete_early        what those of discrete time share
eager                 the monitor of verdicts as soon as they are settled
dense_early           what those of dense time share, and the monitor of such verdicts
interval              bounds of the robustness: late samples and corrections
discrete_interval     the monitor of bounds in discrete time
dense_interval        the monitor of bounds in dense time
member_bounds         bounds in discrete time of quantifiers over members that come and go
causation             what each sample alone causes: what its monitors share
discrete_causation    the monitor of causation in discrete time
dense_causation       the monitor of causation in dense time
prediction            predictions of later samples, and the radius of their errors
caller_clock          times of early monitors in the format of the caller
early_check           whether a recording can no longer change a verdict (``rtamt check --early``)
dense_early_check     the same in dense time
evidence              which samples decided a verdict
at_start              bounds and verdict at the start of the trace
standalone            compile a requirement to a program that runs without Python
====================  =================================================================
"""
