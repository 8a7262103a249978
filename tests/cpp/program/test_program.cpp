#include "program/program.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <functional>
#include <limits>
#include <stdexcept>

using programs::Builder;
using programs::bytes_of;
using programs::sealed;
using rtamt::Domain;
using rtamt::Opcode;
using rtamt::Program;
using Bytes = std::vector<std::uint8_t>;

// always[0,3](a - b >= 1.5) with a note
static Program example() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto limit = builder.constant(1.5);
    const auto difference = builder.pointwise(Opcode::sub, a, b);
    const auto margin = builder.pointwise(Opcode::sub, difference, limit);
    builder.output(builder.unary(Opcode::slide_min, margin, 4, 3));
    builder.output(margin);
    Program program = builder.program();
    program.note = R"({"name":"always"})";
    return program;
}

static std::string refusal(const Bytes& bytes) {
    return thrown<std::invalid_argument>([&] { (void)Program::parse(bytes); });
}

static std::string refusal_of(const std::function<void(Program&)>& spoil) {
    Program program = example();
    spoil(program);
    return refusal(bytes_of(program));
}

static std::string refused(const std::string& reason) {
    return "This is not a program that can be run: " + reason + ".";
}

TEST_CASE("what was written is read") {
    const Program program = example();
    const Program read = Program::parse(bytes_of(program));
    CHECK((read.inputs == 2 && read.note == program.note && read.outputs == program.outputs));
    CHECK(read.instructions.size() == program.instructions.size());
    for (std::size_t i = 0; i < read.instructions.size(); ++i) {
        const auto& got = read.instructions[i];
        const auto& expected = program.instructions[i];
        CHECK((got.opcode == expected.opcode && got.a == expected.a && got.b == expected.b));
        CHECK((got.n == expected.n && got.x == expected.x && got.lag == expected.lag));
    }
    CHECK(read.latest() == 3);
    CHECK(read.operand_lag(read.instructions[5]) == 0);
}

TEST_CASE("lag of operands ignores constants") {
    Builder builder;
    const auto late = builder.later(builder.input(), 9);
    const auto one = builder.constant(1.0);
    const auto sum = builder.pointwise(Opcode::add, one, late);
    CHECK(builder.lag(sum) == 9);
    builder.output(sum);
    CHECK(Program::parse(bytes_of(builder.program())).latest() == 9);
}

TEST_CASE("no truncation is read") {
    const Bytes bytes = bytes_of(example());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        const std::string expected =
            size < 36 ? refused("it has " + std::to_string(size) +
                                " bytes, fewer than the 36 of the shortest one")
                      : refused("it has " + std::to_string(size) +
                                " bytes where its header promises " + std::to_string(bytes.size()));
        CHECK(refusal(part) == expected);
    }
    Bytes longer = bytes;
    longer.push_back(0);
    CHECK(refusal(longer) ==
          refused("it has " + std::to_string(bytes.size() + 1) +
                  " bytes where its header promises " + std::to_string(bytes.size())));
}

TEST_CASE("no flipped bit is read") {
    const Bytes bytes = bytes_of(example());
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        Bytes damaged = bytes;
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        CHECK(refusal(damaged).starts_with("This is not a program that can be run: "));
    }
    Bytes damaged = bytes;
    damaged[40] ^= 1U;
    CHECK(refusal(damaged) == refused("its checksum does not match, so it was damaged on the way"));
}

TEST_CASE("inputs that no instruction reads are bounded in number") {
    Program program = example();
    program.inputs = 65536;
    CHECK(Program::parse(bytes_of(program)).inputs == 65536);
    program.inputs = 65537;
    CHECK(refusal(bytes_of(program)) ==
          refused("it promises 65537 inputs, more than the 65536 that are possible for one of its "
                  "size"));
}

TEST_CASE("header is checked") {
    const Bytes bytes = bytes_of(example());
    const auto with = [&](std::size_t place, std::uint8_t value) {
        Bytes changed = bytes;
        changed[place] = value;
        return refusal(sealed(changed));
    };
    CHECK(with(0, 'X') == refused("it does not begin with \"RTAMTPRG\""));
    CHECK(with(8, 2) == refused("its format has version 2, this core reads version 1"));
    CHECK(with(10, 1) == refused("it is for dense time, and discrete time is wanted here"));
    CHECK(with(10, 7) == refused("it is for the unknown time domain 7"));
    CHECK(with(11, 4) == refused("it leaves out unknown passes (4)"));
    CHECK(with(28, 2) == refused("it has unknown options (2)"));
    CHECK(with(15, 255).starts_with(refused("").substr(0, 39) + "it has "));
    CHECK(with(33, 1) == refused("a reserved byte of instruction 0 is not zero"));
    CHECK(with(32 + 12, 1) == refused("a reserved byte of instruction 0 is not zero"));
    CHECK(with(32, 255) == refused("instruction 0 has the unknown opcode 255"));
}

TEST_CASE("sizes that would overflow are refused") {
    Bytes bytes = bytes_of(example());
    for (const std::size_t place : std::initializer_list<std::size_t>{12, 20, 24}) {
        for (std::size_t i = 0; i < 4; ++i)
            bytes[place + i] = 0xFF;
    }
    CHECK(refusal(sealed(bytes)) ==
          refused("it has " + std::to_string(bytes.size()) + " bytes where its header promises " +
                  std::to_string(36 + 48 * 0xFFFFFFFFULL - 3 * 0xFFFFFFFFULL)));
}

TEST_CASE("operands are checked") {
    CHECK(refusal_of([](Program& p) { p.instructions[3].b = 3; }) ==
          refused("instruction 3 (sub) reads instruction 3, which is not before it"));
    CHECK(refusal_of([](Program& p) { p.instructions[3].a = 4; }) ==
          refused("instruction 3 (sub) reads instruction 4, which is not before it"));
    CHECK(refusal_of([](Program& p) { p.instructions[3].b = rtamt::no_operand; }) ==
          refused("instruction 3 (sub) lacks an operand"));
    CHECK(refusal_of([](Program& p) { p.instructions[5].b = 1; }) ==
          refused("instruction 5 (slide_min) has an operand too many"));
    CHECK(refusal_of([](Program& p) { p.instructions[1].a = 0; }) ==
          refused("instruction 1 (input) has an operand too many"));
}

TEST_CASE("numbers are checked") {
    CHECK(refusal_of([](Program& p) { p.instructions[1].n = 2; }) ==
          refused("instruction 1 (input) reads input 2 of 2"));
    CHECK(refusal_of([](Program& p) { p.instructions[1].n = -1; }) ==
          refused("instruction 1 (input) reads input -1 of 2"));
    CHECK(refusal_of([](Program& p) { p.instructions[5].n = 0; }) ==
          refused("instruction 5 (slide_min) has the width 0, outside 1 to 2^48"));
    CHECK(refusal_of([](Program& p) { p.instructions[5].n = rtamt::longest + 1; }) ==
          refused("instruction 5 (slide_min) has the width 281474976710657, outside 1 to 2^48"));
    CHECK(refusal_of([](Program& p) {
              p.instructions[5].opcode = Opcode::shift;
              p.instructions[5].n = -1;
          }) == refused("instruction 5 (shift) has the distance -1, outside 0 to 2^48"));
    CHECK(refusal_of([](Program& p) {
              p.instructions[2].x = std::numeric_limits<double>::quiet_NaN();
          }) == refused("instruction 2 (const) holds a number that is NaN"));
}

TEST_CASE("in dense time windows may be points and bounds are longer") {
    const auto dense = [](const std::function<void(Program&)>& change) {
        Program program = example();
        change(program);
        Bytes bytes = bytes_of(program);
        bytes[10] = 1;
        return sealed(bytes);
    };
    const auto refusal_in_dense = [&](const std::function<void(Program&)>& spoil) {
        return thrown<std::invalid_argument>(
            [&] { (void)Program::parse(dense(spoil), Domain::dense); });
    };
    const Program read = Program::parse(dense([](Program& p) {
                                            p.instructions[5].n = 0;
                                            p.instructions[5].lag = rtamt::longest_dense;
                                        }),
                                        Domain::dense);
    CHECK((read.domain == Domain::dense && read.latest() == rtamt::longest_dense));
    CHECK(Program::parse(bytes_of(example())).domain == Domain::discrete);
    CHECK(refusal_in_dense([](Program& p) { p.instructions[5].n = -1; }) ==
          refused("instruction 5 (slide_min) has the width -1, outside 0 to 2^62"));
    CHECK(refusal_in_dense([](Program& p) { p.instructions[5].lag = rtamt::longest_dense + 1; }) ==
          refused("instruction 5 (slide_min) has the lag 4611686018427387905, outside 0 to 2^62"));
    CHECK(thrown<std::invalid_argument>([] {
              (void)Program::parse(bytes_of(example()), Domain::dense);
          }) == refused("it is for discrete time, and dense time is wanted here"));
}

TEST_CASE("lags are checked") {
    CHECK(refusal_of([](Program& p) { p.instructions[5].lag = -1; }) ==
          refused("instruction 5 (slide_min) has the lag -1, outside 0 to 2^48"));
    CHECK(refusal_of([](Program& p) { p.instructions[5].lag = rtamt::longest + 1; }) ==
          refused("instruction 5 (slide_min) has the lag 281474976710657, outside 0 to 2^48"));
    CHECK(refusal_of([](Program& p) { p.instructions[1].lag = 1; }) ==
          refused("instruction 1 (input) has the lag 1 where only 0 makes sense"));
    CHECK(refusal_of([](Program& p) { p.instructions[2].lag = 1; }) ==
          refused("instruction 2 (const) has the lag 1 where only 0 makes sense"));
    CHECK(refusal_of([](Program& p) { p.instructions[3].lag = 1; }) ==
          refused("instruction 3 (sub) has the lag 1 where its operands have 0"));

    Builder builder;
    const auto a = builder.input();
    const auto late = builder.later(a, 2);
    builder.output(builder.binary(Opcode::since, a, late, 0, 2));
    CHECK(refusal(bytes_of(builder.program())) ==
          refused("instruction 2 (since) mixes operands of lag 0 and 2"));
}

TEST_CASE("outputs are checked") {
    CHECK(refusal_of([](Program& p) { p.outputs.clear(); }) == refused("it has no output"));
    CHECK(refusal_of([](Program& p) { p.outputs[1] = 6; }) ==
          refused("output 1 is instruction 6 of 6"));
}

TEST_CASE("windows of a program for the worst case are steady and not of sums") {
    programs::Builder builder;
    const auto x = builder.input();
    builder.output(builder.unary(Opcode::slide_min, x, 3, 0));
    Program program = builder.program();
    CHECK(!Program::parse(bytes_of(program)).instructions.back().steady);
    program.worst_case = true;
    CHECK(Program::parse(bytes_of(program)).instructions.back().steady);
    program.instructions.back().opcode = Opcode::slide_sum;
    CHECK(refusal(bytes_of(program)) ==
          refused("instruction 1 (slide_sum) is a sum over a window, which takes longer at some "
                  "samples"));
    program.domain = Domain::dense;
    const Bytes dense = bytes_of(program);
    CHECK(thrown<std::invalid_argument>([&] { (void)Program::parse(dense, Domain::dense); }) ==
          refused("it is for the worst case, which there is in discrete time only"));
}
