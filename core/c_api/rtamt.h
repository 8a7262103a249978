/* Monitors for Signal Temporal Logic, from C: a serialised program in, robustness out.
 *
 * `rtamt compile` writes a program; docs/reference/program.md describes its bytes. A monitor runs
 * one program, in discrete or in dense time, whichever the program is for:
 *
 *     rtamt_monitor* monitor;
 *     char message[256];
 *     if (rtamt_create(bytes, size, &monitor, message, sizeof message) != RTAMT_OK) ...
 *     rtamt_value robustness;
 *     rtamt_status status = rtamt_step(monitor, inputs, 2, &robustness, 1);
 *     if (status != RTAMT_OK) puts(rtamt_message(monitor));
 *     else if (robustness.known) printf("%g\n", robustness.value);
 *     rtamt_destroy(monitor);
 *
 * A call that fails leaves the monitor as it was. There is no global state: monitors are
 * independent of each other, and each may be used by one thread at a time. Nothing is thrown.
 *
 * A null pointer is an error like any other: RTAMT_REFUSED for a null monitor, for null memory with
 * a size that is not 0, and for a null place that a result must go to. Functions that return no
 * status return for a null monitor what they return for what does not exist: NULL, 0 or -1. A place
 * that a result need not go to may be null, as it says there.
 */
#ifndef RTAMT_H
#define RTAMT_H

#include <stddef.h>
#include <stdint.h>

#if defined(RTAMT_BUILD) && defined(_WIN32)
#define RTAMT_API __declspec(dllexport)
#elif defined(RTAMT_BUILD)
#define RTAMT_API __attribute__((visibility("default")))
#else
#define RTAMT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Raised when a function changes its meaning or its arguments; functions may be added without. */
#define RTAMT_ABI 1

typedef enum rtamt_status {
    RTAMT_OK = 0,
    RTAMT_REFUSED = 1,   /* the call or its data is wrong */
    RTAMT_UNDEFINED = 2, /* an operation has no value, such as 0/0: see rtamt_failure */
    RTAMT_NO_MEMORY = 3  /* in rtamt_push and rtamt_finish, only rtamt_reset helps then */
} rtamt_status;

/* The values of the domain byte of a program. */
typedef enum rtamt_domain {
    RTAMT_DISCRETE = 0,
    RTAMT_DENSE = 1,
    RTAMT_NO_DOMAIN = -1 /* of a null monitor */
} rtamt_domain;

typedef struct rtamt_monitor rtamt_monitor;

/* A sample of one input in dense time. */
typedef struct rtamt_sample {
    int64_t tick;
    double value;
    uint32_t input;
} rtamt_sample;

/* A value of an output. */
typedef struct rtamt_value {
    double value; /* 0 where it is not known */
    int32_t known;
} rtamt_value;

/* RTAMT_ABI as the library was built. */
RTAMT_API uint32_t rtamt_abi(void);

/* ---- life ------------------------------------------------------------------------------------ */

/* A new monitor of a program; the bytes may go afterwards. A program that is damaged or cannot be
 * run is refused, and the reason is put into `message`, cut to `room` bytes; both
 * may be 0. */
RTAMT_API rtamt_status rtamt_create(const void* program, size_t size, rtamt_monitor** monitor,
                                    char* message, size_t room);

/* Frees a monitor; NULL is none. */
RTAMT_API void rtamt_destroy(rtamt_monitor* monitor);

/* The reason why the last call failed, valid until the next call. */
RTAMT_API const char* rtamt_message(const rtamt_monitor* monitor);

/* After RTAMT_UNDEFINED: the instruction without a value, and the index of the sample, or in dense
 * time the tick; either place may be null. */
RTAMT_API rtamt_status rtamt_failure(const rtamt_monitor* monitor, uint32_t* instruction,
                                     int64_t* step);

/* ---- the metadata of the program ------------------------------------------------------------- */

RTAMT_API rtamt_domain rtamt_time(const rtamt_monitor* monitor);
RTAMT_API const char* rtamt_name(const rtamt_monitor* monitor);    /* may be empty */
RTAMT_API const char* rtamt_formula(const rtamt_monitor* monitor); /* as text */

/* Seconds of a step, exact: the sampling period, in dense time the length of a tick; either place
 * may be null. */
RTAMT_API rtamt_status rtamt_period(const rtamt_monitor* monitor, int64_t* numerator,
                                    int64_t* denominator);

RTAMT_API uint32_t rtamt_inputs(const rtamt_monitor* monitor);
RTAMT_API uint32_t rtamt_outputs(const rtamt_monitor* monitor);
RTAMT_API uint32_t rtamt_parameters(const rtamt_monitor* monitor);

/* Names, valid as long as the monitor; NULL beyond the last one. */
RTAMT_API const char* rtamt_input(const rtamt_monitor* monitor, uint32_t input);
RTAMT_API const char* rtamt_output(const rtamt_monitor* monitor, uint32_t output);
RTAMT_API const char* rtamt_parameter(const rtamt_monitor* monitor, uint32_t parameter);

/* Steps after which the value of an output at an instant is known: its horizon; -1 if there is no
 * such output. */
RTAMT_API int64_t rtamt_lag(const rtamt_monitor* monitor, uint32_t output);

/* ---- parameters, and named constants of the specification ------------------------------------ */

RTAMT_API rtamt_status rtamt_parameter_value(const rtamt_monitor* monitor, uint32_t parameter,
                                             double* value);

/* Only before the first sample, or after rtamt_reset. A Boolean is 1 or 0, a member of an
 * enumeration its code; other values of the two are refused. */
RTAMT_API rtamt_status rtamt_set_parameter(rtamt_monitor* monitor, uint32_t parameter,
                                           double value);

/* The same by the name of the parameter, as rtamt_parameter returns it. */
RTAMT_API rtamt_status rtamt_set_parameter_by_name(rtamt_monitor* monitor, const char* name,
                                                   double value);

/* ---- a trace --------------------------------------------------------------------------------- */

/* Discrete time: takes the next sample, `count` values, one an input. A value that is NaN, or of
 * a declared Boolean neither 1 nor 0, is refused, here as in rtamt_push and in fleets. For each
 * of the first `outputs` outputs, `results` receives the value that has become known, the one
 * `lag` samples ago; it is not known in the first `lag` samples. Allocates nothing, unless the
 * program is one of bounds (rtamt compile --verdict interval): its outputs are lower and upper,
 * bounds of the robustness at the start of the trace for every possible continuation, verdict
 * (infinite, with its sign) and decided_since, the seconds from the first sample to the one that
 * decided; these two are not known while the verdict is open. */
RTAMT_API rtamt_status rtamt_step(rtamt_monitor* monitor, const double* values, size_t count,
                                  rtamt_value* results, size_t outputs);

/* Dense time: takes samples; those of one input at increasing ticks. rtamt_last_output has what
 * became known. The trace starts when every input has started; where several requirements read
 * different inputs, all inputs must start at the same tick. */
RTAMT_API rtamt_status rtamt_push(rtamt_monitor* monitor, const rtamt_sample* samples,
                                  size_t count);

/* No more samples will come: rtamt_last_output has the rest. Then only rtamt_reset helps. */
RTAMT_API rtamt_status rtamt_finish(rtamt_monitor* monitor);

/* Forgets the trace; parameters stay. */
RTAMT_API rtamt_status rtamt_reset(rtamt_monitor* monitor);

/* What the last rtamt_push or rtamt_finish made known of an output: returns how many values, and
 * where their steps (indices of samples, in dense time ticks from which on the value holds) and the
 * values themselves are, valid until the next call; either place may be null. */
RTAMT_API size_t rtamt_last_output(const rtamt_monitor* monitor, uint32_t output,
                                   const int64_t** steps, const double** values);

/* Returns 1 and the last step at which an output is known, or 0 if it is not known anywhere, and -1
 * for a null monitor; the place may be null. */
RTAMT_API int rtamt_known_until(const rtamt_monitor* monitor, uint32_t output, int64_t* step);

/* Discrete time: how many samples came; -1 for a null monitor. */
RTAMT_API int64_t rtamt_sample_count(const rtamt_monitor* monitor);

/* ---- state ----------------------------------------------------------------------------------- */

/* Another monitor in the same state. */
RTAMT_API rtamt_status rtamt_clone(rtamt_monitor* monitor, rtamt_monitor** copy);

/* Writes the state, parameters included; `size` becomes how many bytes it takes. With a null state
 * it asks for the size alone; a state with less room is refused, and nothing is written. The bytes
 * are for this version of the library on this kind of machine. */
RTAMT_API rtamt_status rtamt_save(rtamt_monitor* monitor, void* state, size_t room, size_t* size);

/* Takes over a state that a monitor of the same program has saved; a damaged one is refused, and a
 * forged one does no harm. */
RTAMT_API rtamt_status rtamt_restore(rtamt_monitor* monitor, const void* state, size_t size);

/* ---- many keys ------------------------------------------------------------------------------- */

/* Many monitors of one requirement, by key: vehicles, machines, sessions. A call that fails leaves
 * every key as it was.
 *
 * The program is one of discrete time as for rtamt_create, or what Fleet.compile() in Python and
 * `rtamt compile --fleet` write: that of a fleet in either time domain and any mode. */
typedef struct rtamt_fleet rtamt_fleet;

/* What a fleet reports. */
typedef enum rtamt_mode {
    RTAMT_DELAYED = 0,   /* the robustness, one horizon later */
    RTAMT_EAGER = 1,     /* verdicts, as soon as no later sample can change them */
    RTAMT_INTERVAL = 2,  /* bounds of the robustness */
    RTAMT_CAUSATION = 3, /* by how much each sample alone violates and satisfies the formula */
    RTAMT_NO_MODE = -1   /* of a null fleet */
} rtamt_mode;

/* What a sample has made known of an output. */
typedef struct rtamt_fleet_value {
    double value; /* 0 where it is not known */
    double time; /* that the value is for; NaN where it is not known, and at the start of a trace */
    int32_t known;
    int32_t warming; /* whether it is not known because the program was another one before */
} rtamt_fleet_value;

/* What a sample has made known from `begin` to `end`, in seconds. */
typedef struct rtamt_fleet_row {
    size_t index; /* of the sample in the batch; of a watermark that of the key */
    double begin; /* delayed: of the point, which is the end, too */
    double end;   /* discrete time: of the last sample; dense time: excluded */
    double lower; /* bounds of the robustness; delayed: its value; eager: +inf where the formula */
    double upper; /* holds, -inf where it does not */
    double decided_at; /* eager: the time of the sample that decided; else NaN */
    int32_t is_final;  /* whether no later sample can change the bounds */
} rtamt_fleet_row;

/* Samples of a batch. */
typedef struct rtamt_fleet_batch {
    size_t count;
    const int64_t* keys;          /* of each sample; null where keys are texts */
    const char* const* texts;     /* keys that are texts, in UTF-8; else null */
    const double* times;          /* of each sample, in seconds */
    const double* const* columns; /* of each input, its values; a column may be null: no sample has
                                     a value of the input */
    const double* const* uppers;  /* may be null, and so may be its columns: eager and interval
                                     alone, values are bounds, of which these are the upper ones */
    const uint8_t* const* given;  /* may be null, and so may be its columns: a sample with 0 has no
                                     value of the input. Dense time: it has no sample of it; eager
                                     and interval in discrete time: its value is missing */
} rtamt_fleet_batch;

/* A new fleet for at most `capacity` keys. Discrete time, delayed: a gap between two samples of a
 * key may differ from the period by `tolerance` periods, such as 0.1; in other modes the tolerance
 * is that of the program. Its parameters have the values of the program. `message` as for
 * rtamt_create. */
RTAMT_API rtamt_status rtamt_fleet_create(const void* program, size_t size, size_t capacity,
                                          double tolerance, rtamt_fleet** fleet, char* message,
                                          size_t room);

/* Frees a fleet; NULL is none. */
RTAMT_API void rtamt_fleet_destroy(rtamt_fleet* fleet);

/* The reason why the last call failed, valid until the next call. */
RTAMT_API const char* rtamt_fleet_message(const rtamt_fleet* fleet);

RTAMT_API rtamt_mode rtamt_fleet_mode(const rtamt_fleet* fleet);
RTAMT_API rtamt_domain rtamt_fleet_time(const rtamt_fleet* fleet);

/* The inputs, in the order of the columns, and the outputs: those of the program; lower and upper
 * for bounds, violation and satisfaction for causation; else none. Names are valid as long as the
 * fleet; NULL beyond the last one. */
RTAMT_API uint32_t rtamt_fleet_inputs(const rtamt_fleet* fleet);
RTAMT_API uint32_t rtamt_fleet_outputs(const rtamt_fleet* fleet);
RTAMT_API const char* rtamt_fleet_input(const rtamt_fleet* fleet, uint32_t input);
RTAMT_API const char* rtamt_fleet_output(const rtamt_fleet* fleet, uint32_t output);

/* Takes a batch, keys in any order. A new key starts a trace. `results` receives the values of the
 * first `outputs` outputs, one sample after another: in the modes but delayed those at the start of
 * the trace. A sample that was later than the lateness allows is left out, and the outputs are
 * those before it: see rtamt_fleet_is_late. rtamt_fleet_rows has what became known of other
 * instants. After RTAMT_REFUSED and RTAMT_UNDEFINED, `rejected` is the index in the batch, or
 * `count` if no sample is wrong; it may be null. */
RTAMT_API rtamt_status rtamt_fleet_take(rtamt_fleet* fleet, const rtamt_fleet_batch* batch,
                                        rtamt_fleet_value* results, size_t outputs,
                                        size_t* rejected);

/* The same of samples that have a value of each input: the key and the time in seconds of each, and
 * a column of `count` values for each input. */
RTAMT_API rtamt_status rtamt_fleet_update(rtamt_fleet* fleet, const int64_t* keys,
                                          const double* times, const double* const* columns,
                                          size_t count, rtamt_fleet_value* results, size_t outputs,
                                          size_t* rejected);

/* The same with texts as keys, in UTF-8. The keys of a fleet are all integers or all texts. */
RTAMT_API rtamt_status rtamt_fleet_update_text(rtamt_fleet* fleet, const char* const* keys,
                                               const double* times, const double* const* columns,
                                               size_t count, rtamt_fleet_value* results,
                                               size_t outputs, size_t* rejected);

/* No sample at or before a time will come, of any key: for bounds, and for causation in dense time.
 * `results` receives the values of each key, in the order of rtamt_fleet_key. */
RTAMT_API rtamt_status rtamt_fleet_watermark(rtamt_fleet* fleet, double time,
                                             rtamt_fleet_value* results, size_t outputs);

/* What the last batch or watermark that succeeded has made known of other instants than the start:
 * returns how many rows, and where they are, valid until the next call. Dense time, delayed: a row
 * for each point of the robustness; eager: for each verdict; bounds: for each run whose bounds
 * changed, unless the program reports the start alone; else none. */
RTAMT_API size_t rtamt_fleet_rows(const rtamt_fleet* fleet, const rtamt_fleet_row** rows);

/* How many samples were later than the lateness allows; 0 for a null fleet. */
RTAMT_API uint64_t rtamt_fleet_late(const rtamt_fleet* fleet);

/* 1 if the sample of an index in the last batch that succeeded was later than the lateness allows,
 * and was left out; else 0. */
RTAMT_API int32_t rtamt_fleet_is_late(const rtamt_fleet* fleet, size_t index);

/* Forgets keys; where one is not there, it is refused, and all stay. */
RTAMT_API rtamt_status rtamt_fleet_drop(rtamt_fleet* fleet, const int64_t* keys, size_t count);
RTAMT_API rtamt_status rtamt_fleet_drop_text(rtamt_fleet* fleet, const char* const* keys,
                                             size_t count);

/* Forgets the keys whose last sample is before a time; `dropped` becomes how many, and may be null.
 */
RTAMT_API rtamt_status rtamt_fleet_expire(rtamt_fleet* fleet, double before, size_t* dropped);

/* How many keys there are; 0 for a null fleet. */
RTAMT_API size_t rtamt_fleet_size(const rtamt_fleet* fleet);

/* Returns 1 and the key at an index, in an order that changes when keys come and go: a number, or
 * else a text, valid until the next call; 0 beyond the last one. Either place may be null. */
RTAMT_API int rtamt_fleet_key(const rtamt_fleet* fleet, size_t index, int64_t* key,
                              const char** text);

/* Writes the state of all keys, as rtamt_save does; the bytes are those of Fleet.snapshot() in
 * Python (docs/reference/fleet-state.md). */
RTAMT_API rtamt_status rtamt_fleet_save(rtamt_fleet* fleet, void* state, size_t room, size_t* size);

/* A new fleet in a state that rtamt_fleet_save has written, or Fleet.snapshot(). In discrete time
 * and delayed, maybe of another program: what the two programs share goes on where it was; in dense
 * time and in other modes of the same program. A damaged state is refused. `capacity`: 0 for that
 * of the state. */
RTAMT_API rtamt_status rtamt_fleet_restore(const void* program, size_t size, const void* state,
                                           size_t state_size, size_t capacity, double tolerance,
                                           rtamt_fleet** fleet, char* message, size_t room);

/* ---- many keys, samples in any order ----------------------------------------------------------
 */

/* A fleet of discrete time whose samples come in any order; delayed. Each waits until its key has a
 * sample that is newer by the lateness, or until the watermark has reached it; then it leaves, and
 * is monitored. A call that fails leaves every key as it was. */
typedef struct rtamt_stream rtamt_stream;

/* What a gap between two samples of a key does that is not the period: the call is refused, the
 * trace of the key starts again, or the last values are held where whole periods are missing. */
typedef enum rtamt_gaps { RTAMT_GAPS_REJECT, RTAMT_GAPS_RESTART, RTAMT_GAPS_HOLD } rtamt_gaps;

/* A sample that has left, or that waits: its key, a number or else a text, and its time. The text
 * is valid until the next call. */
typedef struct rtamt_stream_sample {
    int64_t key;
    const char* text; /* null where keys are numbers */
    double time;
} rtamt_stream_sample;

/* As rtamt_fleet_create; `lateness` in seconds: how late a sample may come. */
RTAMT_API rtamt_status rtamt_stream_create(const void* program, size_t size, size_t capacity,
                                           double tolerance, double lateness, rtamt_gaps gaps,
                                           rtamt_stream** stream, char* message, size_t room);

/* Frees a stream; NULL is none. */
RTAMT_API void rtamt_stream_destroy(rtamt_stream* stream);

/* The reason why the last call failed, valid until the next call. */
RTAMT_API const char* rtamt_stream_message(const rtamt_stream* stream);

/* Takes a batch, as rtamt_fleet_update. `late`, which may be null, receives for each sample 1 if it
 * came too late, or a second time, and was left out, else 0. `released`, which may be null, becomes
 * how many samples have left. Where RTAMT_REFUSED or RTAMT_UNDEFINED is for a sample that waited,
 * `rejected` becomes `count`: see rtamt_stream_culprit. */
RTAMT_API rtamt_status rtamt_stream_update(rtamt_stream* stream, const int64_t* keys,
                                           const double* times, const double* const* columns,
                                           size_t count, int32_t* late, size_t* released,
                                           size_t* rejected);

/* The same with texts as keys, in UTF-8. */
RTAMT_API rtamt_status rtamt_stream_update_text(rtamt_stream* stream, const char* const* keys,
                                                const double* times, const double* const* columns,
                                                size_t count, int32_t* late, size_t* released,
                                                size_t* rejected);

/* Sets the watermark: no sample before `time` will come, of any key. What waits up to it leaves. */
RTAMT_API rtamt_status rtamt_stream_watermark(rtamt_stream* stream, double time, size_t* released);

/* A sample that left in the last update or watermark that succeeded: `index` below `released`,
 * those of a key in the order of their times, and what it made known of the first `outputs`
 * outputs. Samples that fill a gap are among them. */
RTAMT_API rtamt_status rtamt_stream_released(rtamt_stream* stream, size_t index,
                                             rtamt_stream_sample* sample,
                                             rtamt_fleet_value* results, size_t outputs);

/* The sample that waited and because of which the last update or watermark failed: itself, or a
 * value that fills the gap before it. It fails again until the sample is discarded, or its key
 * dropped. */
RTAMT_API rtamt_status rtamt_stream_culprit(rtamt_stream* stream, rtamt_stream_sample* sample);

/* Forgets the sample of a key and a time that waits; it is refused if there is none. */
RTAMT_API rtamt_status rtamt_stream_discard(rtamt_stream* stream, int64_t key, double time);
RTAMT_API rtamt_status rtamt_stream_discard_text(rtamt_stream* stream, const char* key,
                                                 double time);

/* As those of fleets. With a key, what waits of it is forgotten. */
RTAMT_API rtamt_status rtamt_stream_drop(rtamt_stream* stream, const int64_t* keys, size_t count);
RTAMT_API rtamt_status rtamt_stream_drop_text(rtamt_stream* stream, const char* const* keys,
                                              size_t count);
RTAMT_API rtamt_status rtamt_stream_expire(rtamt_stream* stream, double before, size_t* dropped);

/* How many keys there are, how many samples wait, and how many were late; 0 for a null stream. */
RTAMT_API size_t rtamt_stream_size(const rtamt_stream* stream);
RTAMT_API size_t rtamt_stream_waiting(const rtamt_stream* stream);
RTAMT_API uint64_t rtamt_stream_late(const rtamt_stream* stream);

/* As those of fleets. Lateness and gaps are part of the state, and what waits is. */
RTAMT_API rtamt_status rtamt_stream_save(rtamt_stream* stream, void* state, size_t room,
                                         size_t* size);
RTAMT_API rtamt_status rtamt_stream_restore(const void* program, size_t size, const void* state,
                                            size_t state_size, size_t capacity, double tolerance,
                                            rtamt_stream** stream, char* message, size_t room);

#ifdef __cplusplus
}
#endif

#endif
