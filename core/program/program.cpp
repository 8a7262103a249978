#include "program.hpp"

#include "crc32.hpp"
#include "reader.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace rtamt {

namespace {

static_assert(std::numeric_limits<double>::is_iec559, "programs store IEEE 754 doubles");

constexpr std::string_view magic = "RTAMTPRG";
constexpr std::uint16_t version = 1;
constexpr std::size_t header_size = 32;
constexpr std::uint32_t worst_case_option = 1;
constexpr std::size_t record_size = 40;
constexpr std::size_t checksum_size = 4;
// Every input takes memory when the program runs, whether or not an instruction reads it: the final
// program of a decomposed requirement has all inputs of the requirement and reads only one result.
// So the bytes alone do not bound the inputs; this does, at 512 KiB for a sample.
constexpr std::size_t most_unread_inputs = std::size_t{1} << 16U;

[[noreturn]] void refuse(const std::string& reason) {
    throw std::invalid_argument("This is not a program that can be run: " + reason + ".");
}

struct Header {
    std::uint8_t domain = 0;
    std::uint8_t without = 0;
    std::uint32_t instructions = 0;
    std::uint32_t inputs = 0;
    std::uint32_t outputs = 0;
    std::uint32_t note = 0;
    std::uint32_t options = 0;
};

Header read_header(Reader& reader, std::size_t size) {
    if (size < header_size + checksum_size) {
        refuse("it has " + std::to_string(size) + " bytes, fewer than the " +
               std::to_string(header_size + checksum_size) + " of the shortest one");
    }
    if (reader.text(magic.size()) != magic) {
        refuse("it does not begin with \"" + std::string(magic) + "\"");
    }
    if (const auto found = reader.take<std::uint16_t>(); found != version) {
        refuse("its format has version " + std::to_string(found) + ", this core reads version " +
               std::to_string(version));
    }
    Header header;
    header.domain = reader.take<std::uint8_t>();
    header.without = reader.take<std::uint8_t>();
    header.instructions = reader.take<std::uint32_t>();
    header.inputs = reader.take<std::uint32_t>();
    header.outputs = reader.take<std::uint32_t>();
    header.note = reader.take<std::uint32_t>();
    header.options = reader.take<std::uint32_t>();
    if (header.options > worst_case_option) {
        refuse("it has unknown options (" + std::to_string(header.options) + ")");
    }
    if (header.without >= 4) {
        refuse("it leaves out unknown passes (" + std::to_string(header.without) + ")");
    }
    const std::uint64_t expected = header_size + std::uint64_t{record_size} * header.instructions +
                                   std::uint64_t{4} * header.outputs + header.note + checksum_size;
    if (size != expected) {
        refuse("it has " + std::to_string(size) + " bytes where its header promises " +
               std::to_string(expected));
    }
    if (const std::size_t most = std::max(size, most_unread_inputs); header.inputs > most) {
        refuse("it promises " + std::to_string(header.inputs) + " inputs, more than the " +
               std::to_string(most) + " that are possible for one of its size");
    }
    return header;
}

// The first error of an instruction, given those before it.
class Checker {
  public:
    Checker(const Program& program, std::size_t index)
        : program_(program), index_(index), instruction_(program.instructions[index]),
          info_(info(instruction_.opcode)), dense_(program.domain == Domain::dense) {}

    void check() const {
        operands();
        numbers();
        lags();
    }

  private:
    const Program& program_;
    std::size_t index_;
    const Instruction& instruction_;
    const OpcodeInfo& info_;
    bool dense_;

    [[nodiscard]] bool sums() const noexcept {
        return instruction_.opcode == Opcode::slide_sum || instruction_.opcode == Opcode::run_sum;
    }

    [[noreturn]] void fail(const std::string& reason) const {
        refuse("instruction " + std::to_string(index_) + " (" + std::string(info_.name) + ") " +
               reason);
    }

    // Fails unless a distance, width or lag lies between `least` and the longest that is possible.
    void bounded(const char* what, std::int64_t value, std::int64_t least) const {
        if (value >= least && value <= (dense_ ? longest_dense : longest)) return;
        fail("has the " + std::string(what) + " " + std::to_string(value) + ", outside " +
             std::to_string(least) + " to " + (dense_ ? "2^62" : "2^48"));
    }

    void operands() const {
        const std::initializer_list<std::uint32_t> operands{instruction_.a, instruction_.b};
        std::size_t place = 0;
        for (const std::uint32_t operand : operands) {
            const bool wanted = place++ < info_.operands;
            if (!wanted && operand != no_operand) fail("has an operand too many");
            if (wanted && operand == no_operand) fail("lacks an operand");
            if (wanted) before(operand);
        }
    }

    void before(std::uint32_t operand) const {
        if (operand < index_) return;
        fail("reads instruction " + std::to_string(operand) + ", which is not before it");
    }

    // A call's number is known to be that of one when its operands are looked at.
    void call() const {
        const std::int64_t n = instruction_.n;
        if (program_.calls.empty()) fail("runs code of its own, which bytes cannot carry");
        if (n < 0 || std::cmp_greater_equal(n, program_.calls.size())) {
            fail("is call " + std::to_string(n) + " of " + std::to_string(program_.calls.size()));
        }
        const CallSite& site = program_.calls[static_cast<std::size_t>(n)];
        if (site.operands.empty()) fail("lacks an operand");
        for (const std::uint32_t operand : site.operands)
            before(operand);
        if (site.kernel->version != rtamt_kernel_version) {
            fail("was built for version " + std::to_string(site.kernel->version) +
                 " of rtamt/kernel.hpp, this core has version " +
                 std::to_string(rtamt_kernel_version) + "; build it again");
        }
        if (dense_ ? site.kernel->advance == nullptr : site.kernel->run == nullptr) {
            fail(dense_ ? "is for discrete time, and dense time is wanted here"
                        : "is for dense time, and discrete time is wanted here");
        }
    }

    void numbers() const {
        const std::int64_t n = instruction_.n;
        if (std::isnan(instruction_.x)) fail("holds a number that is NaN");
        switch (info_.count) {
        case Count::none:
            break;
        case Count::input:
            if (n < 0 || n >= std::int64_t{program_.inputs}) {
                fail("reads input " + std::to_string(n) + " of " + std::to_string(program_.inputs));
            }
            break;
        case Count::distance:
            bounded("distance", n, 0);
            break;
        case Count::width:
            bounded("width", n, dense_ ? 0 : 1);
            if (program_.worst_case && instruction_.opcode == Opcode::slide_sum) {
                fail("is a sum over a window, which takes longer at some samples");
            }
            break;
        case Count::rank:
            bounded("width", n, 1);
            rank();
            break;
        case Count::call:
            call();
            break;
        }
    }

    // The c-th of w values is selected; the one after the last means none.
    void rank() const {
        const double x = instruction_.x;
        if (x >= 1.0 && x <= static_cast<double>(instruction_.n) + 1.0 && x == std::floor(x))
            return;
        fail("has the rank " + std::to_string(x) +
             ", which is no whole number from 1 to its width");
    }

    void lags() const {
        const std::int64_t lag = instruction_.lag;
        bounded("lag", lag, 0);
        if (info_.operands == 0 && info_.count != Count::call && lag != 0) {
            fail("has the lag " + std::to_string(lag) + " where only 0 makes sense");
        }
        const std::int64_t expected = program_.operand_lag(instruction_);
        program_.each_operand(instruction_, [&](std::uint32_t operand) {
            const Instruction& source = program_.instructions[operand];
            if (source.opcode != Opcode::constant && source.lag != expected) {
                fail("mixes operands of lag " + std::to_string(expected) + " and " +
                     std::to_string(source.lag));
            }
        });
        if (info_.count == Count::call && lag < expected) {
            fail("has the lag " + std::to_string(lag) + " where its operands have " +
                 std::to_string(expected));
        }
        if (info_.pointwise && lag != expected) {
            fail("has the lag " + std::to_string(lag) + " where its operands have " +
                 std::to_string(expected));
        }
        if (lag < expected && !sums()) { // sums may lie behind their operands
            fail("has the lag " + std::to_string(lag) + ", before its operands are known at " +
                 std::to_string(expected));
        }
    }
};

Instruction read_instruction(Reader& reader, std::size_t index) {
    Instruction instruction;
    const auto code = reader.take<std::uint8_t>();
    if (code >= opcodes.size()) {
        refuse("instruction " + std::to_string(index) + " has the unknown opcode " +
               std::to_string(code));
    }
    instruction.opcode = static_cast<Opcode>(code);
    bool clean = true;
    for (int i = 0; i < 3; ++i)
        clean = reader.take<std::uint8_t>() == 0 && clean;
    instruction.a = reader.take<std::uint32_t>();
    instruction.b = reader.take<std::uint32_t>();
    clean = reader.take<std::uint32_t>() == 0 && clean;
    if (!clean) {
        refuse("a reserved byte of instruction " + std::to_string(index) + " is not zero");
    }
    instruction.n = std::bit_cast<std::int64_t>(reader.take<std::uint64_t>());
    instruction.x = std::bit_cast<double>(reader.take<std::uint64_t>());
    instruction.lag = std::bit_cast<std::int64_t>(reader.take<std::uint64_t>());
    return instruction;
}

} // namespace

Program Program::parse(std::span<const std::uint8_t> bytes, Domain domain,
                       std::vector<CallSite> calls) {
    Reader reader(bytes);
    const Header header = read_header(reader, bytes.size());
    const auto body = bytes.first(bytes.size() - checksum_size);
    if (Reader(bytes.last(checksum_size)).take<std::uint32_t>() != crc32(body)) {
        refuse("its checksum does not match, so it was damaged on the way");
    }
    if (header.domain > 1) {
        refuse("it is for the unknown time domain " + std::to_string(header.domain));
    }
    if (static_cast<Domain>(header.domain) != domain) {
        refuse(domain == Domain::dense ? "it is for discrete time, and dense time is wanted here"
                                       : "it is for dense time, and discrete time is wanted here");
    }
    if (header.outputs == 0) refuse("it has no output");

    Program program;
    program.domain = domain;
    program.without = header.without;
    program.worst_case = header.options == worst_case_option;
    if (program.worst_case && domain == Domain::dense) {
        refuse("it is for the worst case, which there is in discrete time only");
    }
    program.calls = std::move(calls);
    program.inputs = header.inputs;
    program.instructions.reserve(header.instructions);
    for (std::size_t index = 0; index < header.instructions; ++index) {
        program.instructions.push_back(read_instruction(reader, index));
        Checker(program, index).check();
        program.instructions.back().steady = program.worst_case;
        program.instructions.back().truth = program.is_truth(program.instructions.back());
    }
    program.outputs.reserve(header.outputs);
    for (std::size_t place = 0; place < header.outputs; ++place) {
        const auto index = reader.take<std::uint32_t>();
        if (index >= header.instructions) {
            refuse("output " + std::to_string(place) + " is instruction " + std::to_string(index) +
                   " of " + std::to_string(header.instructions));
        }
        program.outputs.push_back(index);
    }
    program.note = reader.text(header.note);
    return program;
}

std::int64_t Program::operand_lag(const Instruction& instruction) const noexcept {
    std::int64_t lag = -1;
    each_operand(instruction, [&](std::uint32_t operand) {
        const Instruction& source = instructions[operand];
        if (lag < 0 && source.opcode != Opcode::constant) lag = source.lag;
    });
    return std::max<std::int64_t>(lag, 0);
}

bool Program::is_truth(const Instruction& instruction) const noexcept {
    const auto truth = [&](std::uint32_t operand) { return instructions[operand].truth; };
    switch (instruction.opcode) {
    case Opcode::constant:
        return std::isinf(instruction.x);
    case Opcode::holds_gt:
    case Opcode::holds_ge:
    case Opcode::holds_eq:
        return true;
    case Opcode::shift: {
        // The replacement of absent values, unless it is itself absent everywhere.
        const bool hidden = instruction.lag == operand_lag(instruction) + instruction.n;
        return truth(instruction.a) && (hidden || std::isinf(instruction.x));
    }
    case Opcode::neg:
    case Opcode::slide_max:
    case Opcode::slide_min:
    case Opcode::run_max:
    case Opcode::run_min:
        return truth(instruction.a);
    case Opcode::min:
    case Opcode::max:
    case Opcode::since:
    case Opcode::until:
        return truth(instruction.a) && truth(instruction.b);
    default:
        return false;
    }
}

bool Program::can_fail(const Instruction& instruction) const noexcept {
    if (!info(instruction.opcode).partial) return false;
    const auto harmless = [&](std::uint32_t operand, bool zero_too) {
        if (!is_constant(operand)) return false;
        const double x = instructions[operand].x;
        return std::isfinite(x) && (zero_too || x != 0.0);
    };
    switch (instruction.opcode) {
    case Opcode::add:
    case Opcode::sub:
        return !harmless(instruction.a, true) && !harmless(instruction.b, true);
    case Opcode::mul:
    case Opcode::div:
        return !harmless(instruction.a, false) && !harmless(instruction.b, false);
    case Opcode::slide_sum:
    case Opcode::run_sum:
        return domain == Domain::discrete && !harmless(instruction.a, true); // else it counts
    default:
        return true;
    }
}

std::vector<bool> Program::guarded() const {
    std::vector<bool> guarded(instructions.size(), false);
    for (std::size_t i = guarded.size(); i-- > 0;) {
        const Instruction& instruction = instructions[i];
        if (can_fail(instruction)) guarded[i] = true;
        if (!guarded[i]) continue;
        each_operand(instruction, [&](std::uint32_t operand) { guarded[operand] = true; });
    }
    return guarded;
}

std::int64_t Program::latest() const noexcept {
    std::int64_t latest = 0;
    for (const std::uint32_t output : outputs) {
        latest = std::max(latest, instructions[output].lag);
    }
    return latest;
}

} // namespace rtamt
