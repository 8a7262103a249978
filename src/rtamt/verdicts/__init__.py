"""Determine whether a requirement holds, and when it is first violated.

===============  =================================================================
module           purpose
===============  =================================================================
decompose        split a formula into windows that start at the first sample
first_violation  the first violation, for complete signals or chunks
streaming        ``check_stream``: check a recording in chunks with bounded memory
===============  =================================================================
"""
