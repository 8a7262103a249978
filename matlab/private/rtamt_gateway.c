/* The C API (rtamt.h) for MATLAB and Octave: one MEX function whose first argument says what to do.
 *
 *     id = rtamt_gateway('create', bytes)            uint8, of a program in discrete time
 *     about = rtamt_gateway('describe', id)          a structure: inputs, constants, seconds of a
 *                                                    step, lag
 *     rtamt_gateway('set', id, place, value)         the constant at this place, counted from 1
 *     known = rtamt_gateway('peek', id, values)      what 'step' would give; nothing is taken
 *     known = rtamt_gateway('step', id, values)      takes a sample; NaN: nothing is known yet
 *     [first, values] = rtamt_gateway('finish', id)  the rest, and where it begins
 *     rtamt_gateway('reset', id)                     forgets the trace
 *     rtamt_gateway('destroy', id)
 *
 * A failure is an error 'rtamt:...' with the sentence of the C API. Whoever calls holds numbers,
 * not pointers, so that one that is out of date is refused; `clear mex` frees what is left.
 */
#include "mex.h"
#include "rtamt.h"

#include <stdlib.h>
#include <string.h>

/* A peek costs what a step costs: a second monitor goes ahead by one sample, and is copied anew
 * only where the sample that is taken in the end is another one. */
typedef struct session {
    double id;
    rtamt_monitor* taken; /* has every sample that was taken */
    rtamt_monitor* ahead; /* NULL, or level with `taken`, or one sample ahead */
    double* row;          /* that sample */
    rtamt_value* known;   /* and what it made known, of each output */
    struct session* next;
} session;

/* A MEX function has no other place for what lives longer than a call. */
static session* sessions = NULL;
static double last_id = 0.0;

static void release(session* old) {
    rtamt_destroy(old->ahead);
    rtamt_destroy(old->taken);
    free(old->known);
    free(old->row);
    free(old);
}

static void forget_ahead(session* self) {
    rtamt_destroy(self->ahead);
    self->ahead = NULL;
}

static void release_all(void) {
    while (sessions != NULL) {
        session* next = sessions->next;
        release(sessions);
        sessions = next;
    }
}

/* Throws, by `error`: mexErrMsgIdAndTxt of Octave would put the name of this file first. */
static void refuse(const char* identifier, const char* sentence) {
    mxArray* arguments[3];
    arguments[0] = mxCreateString(identifier);
    arguments[1] = mxCreateString("%s");
    arguments[2] = mxCreateString(sentence);
    (void)mexCallMATLAB(0, NULL, 3, arguments, "error");
}

static void check(rtamt_status status, const rtamt_monitor* monitor) {
    if (status != RTAMT_OK) refuse("rtamt:sample", rtamt_message(monitor));
}

/* ---- arguments ------------------------------------------------------------------------------- */

/* The place that holds the session, so that it can be taken out of the list. */
static session** find(int count, const mxArray* arguments[]) {
    session** place = &sessions;
    double id = 0.0;
    if (count < 2 || !mxIsDouble(arguments[1]) || mxGetNumberOfElements(arguments[1]) != 1) {
        refuse("rtamt:usage", "The second argument is the number that 'create' gave.");
    }
    id = mxGetScalar(arguments[1]);
    while (*place != NULL && (*place)->id != id)
        place = &(*place)->next;
    if (*place == NULL) {
        refuse("rtamt:usage", "There is no monitor of this number: it was destroyed.");
    }
    return place;
}

static const double* values_of(int count, const mxArray* arguments[], size_t* size) {
    if (count < 3 || !mxIsDouble(arguments[2]) || mxIsComplex(arguments[2])) {
        refuse("rtamt:usage", "The third argument is a sample: a vector of real doubles.");
    }
    *size = mxGetNumberOfElements(arguments[2]);
    return mxGetPr(arguments[2]);
}

/* ---- what can be done ------------------------------------------------------------------------ */

typedef void command(int results, mxArray* result[], int count, const mxArray* arguments[]);

static void create(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    char message[400] = "";
    rtamt_monitor* monitor = NULL;
    session* fresh = NULL;
    (void)results;
    if (count < 2 || !mxIsUint8(arguments[1])) {
        refuse("rtamt:usage", "The second argument holds the bytes of a program, as uint8.");
    }
    if (rtamt_create(mxGetData(arguments[1]), mxGetNumberOfElements(arguments[1]), &monitor,
                     message, sizeof message) != RTAMT_OK) {
        refuse("rtamt:program", message);
    }
    if (rtamt_time(monitor) != RTAMT_DISCRETE) {
        rtamt_destroy(monitor);
        refuse("rtamt:program", "The program is for dense time, but samples come once a period: "
                                "compile it without '--time dense'.");
    }
    fresh = calloc(1, sizeof *fresh);
    if (fresh != NULL) {
        fresh->taken = monitor;
        fresh->row = calloc(rtamt_inputs(monitor) + 1U, sizeof(double));
        fresh->known = calloc(rtamt_outputs(monitor) + 1U, sizeof(rtamt_value));
        if (fresh->row == NULL || fresh->known == NULL) {
            release(fresh);
            fresh = NULL;
        }
    } else {
        rtamt_destroy(monitor);
    }
    if (fresh == NULL) refuse("rtamt:memory", "There is not enough memory.");
    last_id += 1.0;
    fresh->id = last_id;
    fresh->next = sessions;
    sessions = fresh;
    result[0] = mxCreateDoubleScalar(fresh->id);
}

static void describe(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    const char* fields[] = {"inputs", "constants", "seconds", "lag"};
    const rtamt_monitor* monitor = (*find(count, arguments))->taken;
    const uint32_t inputs = rtamt_inputs(monitor);
    const uint32_t parameters = rtamt_parameters(monitor);
    mxArray* names = mxCreateCellMatrix(1, inputs);
    mxArray* constants = mxCreateCellMatrix(1, parameters);
    int64_t numerator = 0;
    int64_t denominator = 1;
    (void)results;
    for (uint32_t i = 0; i < inputs; ++i)
        mxSetCell(names, i, mxCreateString(rtamt_input(monitor, i)));
    for (uint32_t i = 0; i < parameters; ++i)
        mxSetCell(constants, i, mxCreateString(rtamt_parameter(monitor, i)));
    rtamt_period(monitor, &numerator, &denominator);
    result[0] = mxCreateStructMatrix(1, 1, 4, fields);
    mxSetField(result[0], 0, "inputs", names);
    mxSetField(result[0], 0, "constants", constants);
    mxSetField(result[0], 0, "seconds",
               mxCreateDoubleScalar((double)numerator / (double)denominator));
    mxSetField(result[0], 0, "lag", mxCreateDoubleScalar((double)rtamt_lag(monitor, 0)));
}

static void set(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session* self = *find(count, arguments);
    uint32_t place = 0;
    (void)results;
    (void)result;
    for (int i = 2; i < 4; ++i) {
        if (i >= count || !mxIsDouble(arguments[i]) || mxGetNumberOfElements(arguments[i]) != 1) {
            refuse("rtamt:usage", "The third argument is a place, the fourth one a number.");
        }
    }
    place = (uint32_t)mxGetScalar(arguments[2]) - 1U;
    if (rtamt_set_parameter(self->taken, place, mxGetScalar(arguments[3])) != RTAMT_OK) {
        refuse("rtamt:constants", rtamt_message(self->taken));
    }
    forget_ahead(self);
}

static int is_ahead(const session* self) {
    return self->ahead != NULL && rtamt_sample_count(self->ahead) > rtamt_sample_count(self->taken);
}

static int is_row(const session* self, const double* values, size_t size) {
    return size == rtamt_inputs(self->taken) &&
           memcmp(self->row, values, size * sizeof(double)) == 0;
}

static mxArray* row_of(const double* values, size_t count) {
    mxArray* array = mxCreateDoubleMatrix(1, (mwSize)count, mxREAL);
    memcpy(mxGetPr(array), values, count * sizeof(double));
    return array;
}

/* A Simulink signal has a value in every step: NaN until the first is known. */
static mxArray* known_row(const rtamt_value* values, size_t count) {
    mxArray* array = mxCreateDoubleMatrix(1, (mwSize)count, mxREAL);
    for (size_t i = 0; i < count; ++i)
        mxGetPr(array)[i] = values[i].known ? values[i].value : mxGetNaN();
    return array;
}

static void peek(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session* self = *find(count, arguments);
    size_t size = 0;
    const double* values = values_of(count, arguments, &size);
    const size_t outputs = rtamt_outputs(self->taken);
    (void)results;
    if (is_ahead(self) && !is_row(self, values, size)) forget_ahead(self);
    if (self->ahead == NULL) check(rtamt_clone(self->taken, &self->ahead), self->taken);
    if (!is_ahead(self)) {
        check(rtamt_step(self->ahead, values, size, self->known, outputs), self->ahead);
        memcpy(self->row, values, size * sizeof(double));
    }
    result[0] = known_row(self->known, outputs);
}

static void step(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session* self = *find(count, arguments);
    size_t size = 0;
    const double* values = values_of(count, arguments, &size);
    const size_t outputs = rtamt_outputs(self->taken);
    const int was_ahead = is_ahead(self);
    (void)results;
    check(rtamt_step(self->taken, values, size, self->known, outputs), self->taken);
    result[0] = known_row(self->known, outputs);
    if (!was_ahead || !is_row(self, values, size)) forget_ahead(self);
}

static void finish(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session* self = *find(count, arguments);
    const int64_t* steps = NULL;
    const double* values = NULL;
    size_t known = 0;
    check(rtamt_finish(self->taken), self->taken);
    forget_ahead(self);
    known = rtamt_last_output(self->taken, 0, &steps, &values);
    result[0] = mxCreateDoubleScalar(known == 0 ? 0.0 : (double)steps[0]);
    if (results > 1) result[1] = row_of(values, known);
}

static void reset(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session* self = *find(count, arguments);
    (void)results;
    (void)result;
    rtamt_reset(self->taken);
    forget_ahead(self);
}

static void destroy(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    session** place = find(count, arguments);
    session* old = *place;
    (void)results;
    (void)result;
    *place = old->next;
    release(old);
}

void mexFunction(int results, mxArray* result[], int count, const mxArray* arguments[]) {
    static const struct {
        const char* name;
        command* run;
    } commands[] = {{"peek", peek}, {"step", step},     {"create", create}, {"describe", describe},
                    {"set", set},   {"finish", finish}, {"reset", reset},   {"destroy", destroy}};
    char name[16] = "";
    mexAtExit(release_all);
    if (count > 0 && mxIsChar(arguments[0]) && mxGetString(arguments[0], name, sizeof name) == 0) {
        for (size_t i = 0; i < sizeof commands / sizeof *commands; ++i) {
            if (strcmp(commands[i].name, name) == 0) {
                commands[i].run(results, result, count, arguments);
                return;
            }
        }
    }
    refuse("rtamt:usage", "The first argument says what to do, such as 'step'.");
}
