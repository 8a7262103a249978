// FMI 3.0: the standard's own types and declarations, and how our definitions are exported.
#pragma once

#include <fmi3Functions.h>

#define RTAMT_FMI3_EXPORT extern "C" FMI3_Export
