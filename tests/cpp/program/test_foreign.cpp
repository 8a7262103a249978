#include "program/foreign.hpp"

#include "check.hpp"

#include <cstdint>
#include <string>

using rtamt::Foreign;

namespace {

// Counts what it takes; -1 breaks it, and a begin of -2 keeps it from being made.
class Count {
  public:
    explicit Count(const rtamt_setup& setup) {
        if (setup.begin == -2) throw std::invalid_argument("no such interval");
    }
    void run(const rtamt_samples& samples) {
        for (std::size_t i = 0; i < samples.count; ++i) {
            total_ += samples.operands[0][i];
            if (samples.operands[0][i] == -1) throw std::domain_error("minus one");
            if (samples.operands[0][i] == -3) throw 3; // NOLINT(*-exception-baseclass): anything
            samples.out[i] = total_;
        }
    }

  private:
    double total_ = 0;
};

struct One {
    Foreign foreign;
    explicit One(const rtamt_kernel& kernel) : foreign(kernel, {0, -1, 1.0, 1}) {}

    std::string take(double value) {
        const double* operand = &value;
        double out = 0;
        const char* error = foreign.run({&operand, 1, false, &out, 1});
        return error != nullptr ? error : std::to_string(static_cast<int>(out));
    }
};

RTAMT_KERNEL(rtamt_test_count, Count)

} // namespace

TEST_CASE("a class becomes a kernel") {
    One one(*rtamt_test_count());
    CHECK((one.take(2) == "2" && one.take(3) == "5"));
    one.foreign.reset();
    CHECK(one.take(1) == "1");
    CHECK((rtamt_test_count()->advance == nullptr && rtamt_test_count()->version == 1));
}

TEST_CASE("what it throws is reported and taken back") {
    One one(*rtamt_test_count());
    CHECK(one.take(2) == "2");
    one.foreign.checkpoint();
    CHECK(one.take(-1) == "minus one");
    one.foreign.rollback();
    CHECK(one.take(1) == "3");
    one.foreign.checkpoint();
    CHECK(one.take(-3) == "an exception that is no std::exception");
    one.foreign.rollback();
    CHECK(one.take(1) == "4");
}

TEST_CASE("a kernel that cannot be made says why") {
    CHECK(thrown<std::runtime_error>([] {
              const Foreign foreign(*rtamt_test_count(), {-2, -1, 1.0, 1});
          }) == "no such interval");
}

namespace {

// Keeps its own checkpoint.
class Own {
  public:
    explicit Own(const rtamt_setup& /*setup*/) {}
    ~Own() = default;
    Own(const Own&) = delete;
    Own& operator=(const Own&) = delete;
    Own(Own&&) = delete;
    Own& operator=(Own&&) = delete;
    void run(const rtamt_samples& samples) { *samples.out = ++runs_; }
    void checkpoint() { saved_ = runs_; }
    void rollback() { runs_ = saved_; }

  private:
    int runs_ = 0;
    int saved_ = 0;
};

} // namespace

TEST_CASE("a checkpoint of its own goes before a copy") {
    const rtamt_kernel kernel = rtamt::KernelOf<Own>::table();
    One one(kernel);
    CHECK(one.take(0) == "1");
    one.foreign.checkpoint();
    CHECK(one.take(0) == "2");
    one.foreign.rollback();
    CHECK(one.take(0) == "2");
}
