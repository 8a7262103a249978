// FMI 2.0: the standard's own types and declarations, and how our definitions are exported.
#pragma once

#include <fmi2Functions.h>

#define RTAMT_FMI2_EXPORT extern "C" FMI2_Export
