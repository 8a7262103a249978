// A kernel that follows each component of its operand by itself (values/components.hpp).
//
// A part takes the values of a component and gives the changes of the result, in the order of time.
//
// Cost, memory: those of the parts.
#pragma once

#include "../values/components.hpp"
#include "kernel.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rtamt::dense {

// From this time on a component of the result has this value.
struct Change {
    std::int64_t time;
    double value;
};

template <ValueDomain D, class Part>
class Parted final : public Temporal<D> {
  public:
    using Value = typename D::Value;
    using Base = Temporal<D>;
    using Parts = Components<D>;

    // The result is `outside` as long as the operand has brought nothing.
    template <class... Settings>
    explicit Parted(std::int64_t lag, const Value& outside, Settings... settings)
        : Base(lag, outside) {
        for (auto& part : parts_)
            part.configure(settings...);
    }

    std::int64_t run(std::int64_t frontier) override {
        const BasicEvents<Value> a = Kernel::a<Value>();
        std::size_t count = 0;
        for (std::size_t i = 0; i < Parts::count; ++i) {
            changes_[i].clear();
            for (std::size_t k = 0; k < a.count; ++k)
                parts_[i].take(a.times[k], Parts::get(a.values[k], i), changes_[i]);
            parts_[i].finish(frontier, changes_[i]);
            count += changes_[i].size();
        }
        auto out = this->open(count);
        Value value = out.last;
        std::array<std::size_t, Parts::count> next{};
        for (;;) {
            std::int64_t time = never;
            for (std::size_t i = 0; i < Parts::count; ++i) {
                if (next[i] < changes_[i].size()) time = std::min(time, changes_[i][next[i]].time);
            }
            if (time == never) break;
            for (std::size_t i = 0; i < Parts::count; ++i) {
                while (next[i] < changes_[i].size() && changes_[i][next[i]].time == time) {
                    Parts::set(value, i, changes_[i][next[i]++].value);
                }
            }
            out.put(time, value);
        }
        this->close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Base::checkpoint();
        for (auto& part : parts_)
            part.checkpoint();
    }
    void rollback() noexcept override {
        Base::rollback();
        for (auto& part : parts_)
            part.rollback();
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Base::transfer(snapshot, frontier);
        for (auto& part : parts_)
            part.transfer(snapshot, frontier);
    }

    [[nodiscard]] std::size_t pending() const noexcept override {
        std::size_t most = 0;
        for (const auto& part : parts_)
            most = std::max(most, 2 * part.size());
        return most;
    }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        std::size_t bytes = Base::bytes();
        for (const auto& part : parts_)
            bytes += part.bytes();
        return bytes;
    }

  protected:
    void reset() noexcept override {
        Base::reset();
        for (auto& part : parts_)
            part.clear();
    }

  private:
    std::array<Part, Parts::count> parts_;
    std::array<std::vector<Change>, Parts::count> changes_; // of a run
};

} // namespace rtamt::dense
