/* What callgrind counts, chosen from Python: benchmarks/instructions.py loads this with ctypes. */
#include <valgrind/callgrind.h>

void start_counting(void) { CALLGRIND_START_INSTRUMENTATION; }

void stop_counting(void) { CALLGRIND_STOP_INSTRUMENTATION; }

/* Forgets what was counted so far. */
void forget(void) { CALLGRIND_ZERO_STATS; }

/* Writes what was counted since, under a name, and forgets it. */
void write_counts(char const *name) { CALLGRIND_DUMP_STATS_AT(name); }
