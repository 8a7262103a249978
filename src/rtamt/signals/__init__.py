"""Convert the caller's data to float64 arrays, integer ticks and timestamps, and represent traces.

=====================  ============================================================================
module                 purpose
=====================  ============================================================================
time_domain_interface  the interfaces of a time domain and of a trace in one
time_domains           the list of time domains
discrete               discrete time and its traces: one value of every variable per sample
dense                  dense time and its traces: timestamps per signal, counted in ticks
signal                 ``Signal``: the result of evaluations and monitors
inexact                missing samples, measurement errors, declared ranges
instants               sets of times as intervals, and step functions of them
shortened              step functions without the middle of long stretches in which nothing changes
outcomes               bounds and verdicts that are known before the whole trace is
episodes               the maximal runs of violation
trace                  ``Trace``: named signals, each with its own time base; resampling
trace_checks           checks of the signals of a trace that a formula reads together
members                the members of groups in recorded data, and where each is present
member_chunks          chunks of streams with members of groups, any of which they may lack
binding                variables under their recorded names, in their declared units
unit_conversion        from the unit of a recording to the declared one
sampling               the latest values of variables as samples one period apart
resampling             signals at other instants: a regular grid, or those of other signals
slicing                a signal between two times
listing                a trace as text: its signals topic by topic
arrays                 data (lists, arrays, frames, objects) to float64 arrays
assumed_period         whether samples without timestamps have a known period
rows                   many traces in one array for each variable, a trace in each row
gaps                   missing samples in containers: None, nulls and masked values
data_errors            errors for missing variables and samples, for NaN and for data of another kind
coding                 names of members to their codes; Booleans are 1 or 0
recoding               codes that a recording has under other numbers: constants of messages
samples                read and check the numbers and the time of one sample
caller_times           timestamps of samples as the caller gives them
runs                   runs of ticks
dense_arrays           dense-time data to int64 ticks and float64 values
sample_count           the number of instants at which any of several signals has a sample
sampling_period        check order and distance of timestamps that are one period apart
inferred_period        infer the sampling period
resolution             the precision of timestamps, and the mean gap of rounded ones
ticks                  times to int64 ticks and back
counting               exact conversion of numbers to ticks, rounded once
epoch                  times since 1970 as text: a date, and the seconds since the start
datetimes              dates and durations of Python, numpy and pandas as integers
time_columns           recognise the time column and its unit by name
=====================  ============================================================================
"""
