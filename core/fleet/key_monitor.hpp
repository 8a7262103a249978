// The monitor of one key, where a fleet has no records: it takes samples and reports what they make
// known. All data is checked here; what is wrong raises WrongSample and leaves a monitor that is to
// be thrown away.
#pragma once

#include "../program/snapshot.hpp"
#include "../values/interval.hpp"
#include "monitor_program.hpp"
#include "state_bytes.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtamt::fleet {

// A sample, by input its value or bounds, and whether it has one.
struct KeySample {
    double time = 0;
    std::span<const Bounds> values;
    std::span<const std::uint8_t> given;
};

// What a sample has made known from `begin` to `end`, in seconds: bounds of the robustness, which
// are equal where it is known; of a verdict both +inf or -inf.
struct Row {
    std::size_t index = 0; // of the sample
    double begin = 0;
    double end = 0;
    Bounds bounds{};
    double decided_at = std::numeric_limits<double>::quiet_NaN();
    bool is_final = true;
};

// What a sample has made of two values at the start of the trace: bounds, or violation and
// satisfaction.
struct AtStart {
    std::array<double, 2> values{};
    bool late = false; // it came too late, and was left out
};

// The rest of a sentence that begins with the key.
struct WrongSample : std::invalid_argument {
    explicit WrongSample(const std::string& rest, bool has_no_value = false)
        : std::invalid_argument(rest), undefined(has_no_value) {}
    bool undefined; // an operation has no value
};

class KeyMonitor {
  public:
    KeyMonitor() = default;
    KeyMonitor(const KeyMonitor&) = delete;
    KeyMonitor& operator=(const KeyMonitor&) = delete;
    KeyMonitor(KeyMonitor&&) = delete;
    KeyMonitor& operator=(KeyMonitor&&) = delete;
    virtual ~KeyMonitor() = default;

    // Takes a sample, of which rows are to have `index`.
    [[nodiscard]] virtual AtStart take(const KeySample& sample, std::size_t index,
                                       std::vector<Row>& rows) = 0;
    // No sample at or before a time will come.
    [[nodiscard]] virtual AtStart watermark(double time, std::size_t index, std::vector<Row>& rows);

    // The state, as src/rtamt/fleet/monitor_state.py writes and reads it.
    [[nodiscard]] virtual std::vector<std::uint8_t> state() = 0;
    virtual void restore(std::span<const std::uint8_t> state) = 0;
    [[nodiscard]] virtual std::size_t bytes() const = 0;
};

// A monitor that has taken no sample. The program must outlive it.
[[nodiscard]] std::unique_ptr<KeyMonitor> make_monitor(const MonitorProgram& program);
[[nodiscard]] std::unique_ptr<KeyMonitor> make_dense_delayed(const MonitorProgram& program);
[[nodiscard]] std::unique_ptr<KeyMonitor> make_dense_early(const MonitorProgram& program);
[[nodiscard]] std::unique_ptr<KeyMonitor> make_discrete_early(const MonitorProgram& program);

// How many values at the start of the trace a sample has.
[[nodiscard]] constexpr std::size_t values_of(MonitorProgram::Mode mode) noexcept {
    using Mode = MonitorProgram::Mode;
    return mode == Mode::interval || mode == Mode::causation ? 2 : 0;
}

// ---- what monitors share ------------------------------------------------------------------------

[[nodiscard]] std::string shown(double number);
[[nodiscard]] std::string shown(const Bounds& bounds);

// Throws for a time that is no number of seconds.
void check_time(double time);
// Throws for the value of an input that is wrong.
void check_value(const MonitorProgram& program, std::size_t input, const Bounds& value,
                 double time);
[[noreturn]] void not_later(double time, double last);
[[noreturn]] void has_no_value(const MonitorProgram& program, std::uint32_t step, double time);
// Throws for what contradicts knowledge; returns whether it adds to it. `known`: by now, `range`:
// before anything came.
[[nodiscard]] bool narrows(const MonitorProgram& program, std::size_t input, const Bounds& value,
                           const Bounds& known, double time);

// The fields of states, as src/rtamt/fleet/fields.py has them.
class StateWriter {
  public:
    template <class Value>
    void put(Value value) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
        out_.insert(out_.end(), bytes, bytes + sizeof(Value));
    }
    void put_count(std::size_t count) { put(std::uint64_t{count}); }
    void put_text(std::string_view text) {
        put_count(text.size());
        out_.insert(out_.end(), text.begin(), text.end());
    }
    void put_data(std::span<const std::uint8_t> bytes) {
        put_count(bytes.size());
        out_.insert(out_.end(), bytes.begin(), bytes.end());
    }
    // What a function transfers, as data.
    template <class Transfer>
    void put_snapshot(Transfer&& transfer) {
        Snapshot snapshot;
        transfer(snapshot);
        put_data(snapshot.bytes());
    }
    [[nodiscard]] std::vector<std::uint8_t>& bytes() noexcept { return out_; }

  private:
    std::vector<std::uint8_t> out_;
};

class StateReader {
  public:
    explicit StateReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    template <class Value>
    [[nodiscard]] Value take() {
        return bytes_.take<Value>();
    }
    [[nodiscard]] std::size_t take_count() {
        const auto count = take<std::uint64_t>();
        if (count > bytes_.left()) refuse("it ends too early");
        return static_cast<std::size_t>(count);
    }
    [[nodiscard]] std::span<const std::uint8_t> take_data() { return bytes_.take(take_count()); }
    // Reads what put_snapshot has written at the end of a state.
    template <class Transfer>
    void take_snapshot(Transfer&& transfer) {
        Snapshot snapshot(take_data());
        transfer(snapshot);
        snapshot.end();
        end();
    }
    [[nodiscard]] std::string_view take_text() {
        const auto text = take_data();
        return {reinterpret_cast<const char*>(text.data()), text.size()};
    }
    // What only monitors of Python remember.
    void nothing(std::size_t bytes) {
        for (std::size_t i = 0; i < bytes; ++i) {
            if (take<std::uint8_t>() != 0) refuse_python();
        }
    }
    [[nodiscard]] bool flag() {
        const auto flag = take<std::uint8_t>();
        if (flag > 1) refuse("it has an unknown value");
        return flag == 1;
    }
    void end() const {
        if (bytes_.left() != 0) refuse("it has bytes that nothing reads");
    }
    [[noreturn]] static void refuse_python() {
        throw std::invalid_argument(
            "This state has what only fleets of Python remember, such as times that are not "
            "seconds: restore it with Fleet.restore.");
    }

  private:
    Bytes bytes_;
};

} // namespace rtamt::fleet
