"""Monitors that report before the horizon: what the samples so far decide about a formula, and which bounds remain.

There are three verdict modes, for both time domains. *Eager* monitors report a verdict as soon as no later sample can
change it. *Interval* monitors report bounds of the robustness, which narrow with each sample. *Causation* monitors
report by how much the newest sample alone violates or satisfies the formula.

==================  ========================================================================
module              purpose
==================  ========================================================================
monitor             what all of these monitors share
discrete            what those of discrete time share
dense               what those of dense time share
discrete_eager      eager verdicts in discrete time
dense_eager         eager verdicts in dense time
interval            bounds of the robustness: late samples and corrections
discrete_interval   the monitor of bounds in discrete time
discrete_samples    the samples that it takes: missing and late ones, and the first of a trace
rehearsal           the first samples of a trace, before it is known where it starts
dense_interval      the monitor of bounds in dense time
member_bounds       bounds in discrete time of quantifiers over members that come and go
causation           what each sample alone causes: what its monitors share
discrete_causation  the monitor of causation in discrete time
dense_causation     the monitor of causation in dense time
at_start            bounds and verdict at the start of the trace
prediction          predictions of later samples, and the radius of their errors
evidence            which samples decided a verdict
caller_clock        times of early monitors in the format of the caller
check               whether a recording can no longer change a verdict (``rtamt check --early``)
dense_check         the same in dense time
==================  ========================================================================
"""
