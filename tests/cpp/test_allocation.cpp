// A running monitor allocates nothing: this stands in front of malloc and of operator new.
#include "discrete/executor.hpp"

#include "discrete/ways.hpp"
#include "programs.hpp"

#include <cstdlib>
#include <new>

namespace {
std::size_t allocations = 0;
}

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* memory, std::size_t size);

void* __wrap_malloc(std::size_t size) {
    ++allocations;
    return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
    ++allocations;
    return __real_calloc(count, size);
}
void* __wrap_realloc(void* memory, std::size_t size) {
    ++allocations;
    return __real_realloc(memory, size);
}
}

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = __real_malloc(size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}

using programs::Builder;
using rtamt::Opcode;
using ways::Executor;
using ways::Outcome;

// Every opcode that has state, some of it under an operation that can fail.
static rtamt::Program everything() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto before = builder.unary(Opcode::shift, a, 3, 0, 0);
    const auto most = builder.unary(Opcode::slide_max, before, 20, 0);
    const auto least = builder.unary(Opcode::run_min, b, 0, 0);
    const auto sum = builder.pointwise(Opcode::add, most, least);
    const auto root = builder.pointwise(Opcode::sqrt, sum);
    const auto since = builder.binary(Opcode::since, root, b, 0, 0);
    const auto until = builder.binary(Opcode::until, since, root, 30, 29);
    builder.output(until).output(root);
    return builder.program();
}

TEST_CASE("counting sees the allocations of a new executor") {
    const std::size_t before = allocations;
    Executor executor(everything());
    CHECK(allocations > before + 10);
}

TEST_CASE("running a monitor allocates nothing") {
    Executor executor(everything());
    double value = 0;
    const std::vector<double> row{5.0, 6.0};
    const std::vector<double> bad{5.0, -1e9};
    const std::vector<double> column(5000, 2.0);
    const std::vector<const double*> columns{column.data(), column.data()};
    std::vector<double> first(5000);
    std::vector<double> second(5000);
    const std::vector<double*> outputs{first.data(), second.data()};

    std::size_t before = allocations;
    for (int i = 0; i < 500; ++i)
        (void)executor.step(row.data(), value);
    const bool failed = executor.step(bad.data(), value) == Outcome::failed;
    CHECK(allocations == before);
    CHECK((failed && executor.samples() == 500));

    executor.reserve(5000);
    before = allocations;
    bool valid = true;
    for (const std::size_t count : std::initializer_list<std::size_t>{1, 200, 256, 257, 5000}) {
        valid = valid && !executor.push(columns, count, outputs);
    }
    for (int i = 0; i < 500; ++i)
        (void)executor.step(row.data(), value);
    valid = valid && !executor.finish(outputs);
    executor.reset();
    for (int i = 0; i < 500; ++i)
        (void)executor.step(row.data(), value);
    CHECK(allocations == before);
    CHECK((valid && executor.samples() == 500));
}
