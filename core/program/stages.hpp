// A plan: programs one after another, with scans of unbounded future between them.
//
// The columns of a plan are its variables and the results of its scans, in this order. A stage
// reads some of them; its scans read its outputs. The last stage has no scans and one output.
#pragma once

#include "program.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rtamt {

enum class ScanKind : std::uint8_t { run_max, run_min, until };

// Until reads two outputs of its stage, the others one.
struct Scan {
    ScanKind kind{};
    std::size_t a = 0;
    std::size_t b = 0;
};

struct Stage {
    Program program;
    std::vector<std::size_t> columns; // by input of the program
    std::vector<Scan> scans;
};

} // namespace rtamt
