/* The C API as C sees it: a program of one instruction, byte by byte. */
#include "c_api/rtamt.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t end = 0;
static unsigned char program[256];

static void put(uint64_t value, size_t size) {
    for (size_t i = 0; i < size; ++i)
        program[end++] = (unsigned char)(value >> (8 * i));
}

static void put_text(const char* text) {
    put(strlen(text), 4);
    memcpy(program + end, text, strlen(text));
    end += strlen(text);
}

static uint32_t crc32(const unsigned char* bytes, size_t size) {
    uint32_t value = 0xFFFFFFFFU;
    for (size_t i = 0; i < size; ++i) {
        value ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1U) != 0 ? (value >> 1) ^ 0xEDB88320U : value >> 1;
    }
    return ~value;
}

static int fail(const char* what) {
    fprintf(stderr, "%s\n", what);
    return 1;
}

int main(void) {
    const size_t length = 8 + 8 + 4 + 4 + 1 + 4 + 1 + 4 + 10 + 4 + 4 + 4;
    memcpy(program, "RTAMTPRG", 8);
    end = 8;
    put(1, 2); /* version */
    put(0, 2); /* discrete time */
    put(1, 4); /* instructions */
    put(1, 4); /* inputs */
    put(1, 4); /* outputs */
    put(length, 4);
    put(0, 4);
    put(0, 4); /* input 0 */
    put(0xFFFFFFFFU, 4);
    put(0xFFFFFFFFU, 4);
    end = 32 + 40; /* and nothing but zeros */
    put(0, 4);     /* output */
    put(1, 8);     /* a step of 1/2 s */
    put(2, 8);
    put_text("");
    put_text("x");
    put_text("x");
    put_text("robustness");
    put(0, 4); /* parameters, labels, bytes of a graph */
    put(0, 4);
    put(0, 4);
    put(crc32(program, end), 4);

    rtamt_monitor* monitor = NULL;
    char message[200] = "";
    if (rtamt_create(program, end, &monitor, message, sizeof message) != RTAMT_OK) {
        return fail(message);
    }
    double value = 2.5;
    rtamt_value known = {0.0, 0};
    if (rtamt_step(monitor, &value, 1, &known, 1) != RTAMT_OK || !known.known ||
        known.value != 2.5) {
        return fail("a sample in, its robustness out");
    }
    value = NAN;
    if (rtamt_step(monitor, &value, 1, &known, 1) != RTAMT_REFUSED) return fail("NaN was taken");
    if (strcmp(rtamt_message(monitor),
               "'x' is NaN at sample 1, time 0.5 s: fill the gap or leave the sample out.") != 0) {
        return fail(rtamt_message(monitor));
    }
    rtamt_destroy(monitor);

    rtamt_fleet* fleet = NULL;
    if (rtamt_fleet_create(program, end, 10, 0.1, &fleet, message, sizeof message) != RTAMT_OK) {
        return fail(message);
    }
    const char* const keys[] = {"a", "b", "a"};
    const double times[] = {0.0, 7.0, 0.5};
    const double numbers[] = {1.0, 2.0, 3.0};
    const double* const columns[] = {numbers};
    rtamt_fleet_value found[3];
    size_t rejected = 0;
    if (rtamt_fleet_update_text(fleet, keys, times, columns, 3, found, 1, &rejected) != RTAMT_OK ||
        rejected != 3 || found[2].value != 3.0 || !found[2].known || found[1].time != 7.0) {
        return fail("a batch in, the values of each sample out");
    }
    if (rtamt_fleet_size(fleet) != 2) return fail("two keys");
    rtamt_fleet_destroy(fleet);
    puts("the C API speaks C");
    return 0;
}
