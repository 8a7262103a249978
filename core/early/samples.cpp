#include "samples.hpp"

#include "../program/snapshot.hpp"

#include <algorithm>
#include <iterator>
#include <ranges>
#include <utility>

namespace rtamt::early {

namespace {

// So many samples are not looked through for what need not wait.
constexpr std::size_t few = 64;

} // namespace

Samples::Samples(std::vector<Bounds> ranges, std::optional<Tick> lateness, bool waits)
    : ranges_(std::move(ranges)), lateness_(lateness), inputs_(ranges_.size()),
      settled_(ranges_.size(), -1), committed_settled_(settled_) {
    now_.waits = committed_.waits = waits;
}

// The index of the first sample later than a time.
std::size_t Samples::after(const Column& column, Tick time) noexcept {
    if (column.empty() || column.back().time <= time) return column.size();
    const auto found = std::ranges::upper_bound(column, time, {}, &Sample::time);
    return static_cast<std::size_t>(found - column.begin());
}

bool Samples::may_come(std::uint32_t input, Tick time) const noexcept {
    if (time <= now_.closed || time >= farthest || time <= -farthest) return false;
    const Tick from = now_.start ? *now_.start : now_.newest.value_or(time);
    if (time - from >= longest) return false;
    return lateness_ || inputs_[input].empty() || time > inputs_[input].back().time;
}

void Samples::add(std::uint32_t input, Tick time, const Bounds& bounds) {
    Column& column = inputs_[input];
    const std::size_t place = after(column, time);
    added_.reserve(added_.size() + 1);
    if (waiting_.size() == waiting_.capacity()) waiting_.reserve(2 * waiting_.size() + few);
    if (place > 0 && column[place - 1].time == time) {
        added_.push_back({input, time, column[place - 1]});
        column[place - 1] = {time, bounds};
    } else {
        column.insert(column.begin() + static_cast<std::ptrdiff_t>(place), {time, bounds});
        added_.push_back({input, time, std::nullopt});
    }
    waiting_.emplace_back(input, time);
    reach(time);
}

void Samples::reach(Tick time) noexcept {
    now_.newest = std::max(now_.newest.value_or(time), time);
    if (lateness_) now_.closed = std::max(now_.closed, *now_.newest - *lateness_ - 1);
    find_start();
}

void Samples::close(Tick time) noexcept {
    now_.closed = std::max(now_.closed, time);
    find_start();
}

std::optional<Tick> Samples::latest_first() const noexcept {
    std::optional<Tick> latest;
    for (const Column& column : inputs_) {
        if (column.empty()) return std::nullopt;
        latest = std::max(latest, std::optional(column.front().time)); // none is less than any
    }
    return latest;
}

// No sample can arrive up to the closed tick, so the first one right behind it is the first of all.
std::optional<Tick> Samples::first_start() const noexcept {
    if (now_.start) return now_.start;
    const auto start = latest_first();
    return lateness_ && start && *start - 1 > now_.closed ? std::nullopt : start;
}

void Samples::find_start() noexcept {
    if (!now_.waits) now_.start = first_start();
}

void Samples::release() noexcept {
    now_.waits = false;
    find_start();
}

Tick Samples::relative(Tick time) const noexcept {
    return time == at_end ? forever : time - *now_.start;
}

Tick Samples::absolute(Tick tick) const noexcept {
    return tick >= forever ? at_end : tick + *now_.start;
}

// Up to which time an input is known.
Tick Samples::certain(std::size_t input) const noexcept {
    const Column& column = inputs_[input];
    if (lateness_ || column.empty()) return now_.closed;
    return std::max(now_.closed, column.back().time);
}

void Samples::collect_closed(std::vector<BoundsEngine::Observation>& observations) {
    observations.clear();
    if (!now_.start) return;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        const Column& column = inputs_[i];
        const Tick before = absolute(settled_[i]);
        const Tick now = std::max(before, certain(i));
        for (std::size_t k = before < now ? after(column, before + 1) - 1 : column.size();
             k < column.size() && column[k].time <= now; ++k) {
            Tick end = now;
            if (k + 1 < column.size()) end = std::min(end, column[k + 1].time - 1);
            const Tick begin = column[k].time + (column[k].collected ? 1 : 0);
            const Tick l = std::max<Tick>(0, relative(std::max(begin, before + 1)));
            const Tick r = relative(end);
            if (l <= r) {
                observations.push_back({static_cast<std::uint32_t>(i), l, r, column[k].bounds});
            }
        }
        settled_[i] = relative(now);
    }
}

void Samples::collect(std::vector<BoundsEngine::Observation>& observations) {
    collect_closed(observations);
    if (!now_.start) return;
    for (const auto& [input, time] : waiting_) {
        const Tick tick = relative(time);
        if (tick <= settled_[input]) continue; // it is among them
        const Column& column = inputs_[input];
        observations.push_back({input, tick, tick, column[after(column, time) - 1].bounds});
    }
}

void Samples::collect_first(Tick origin, Tick from, Tick before,
                            std::vector<BoundsEngine::Observation>& observations) const {
    observations.clear();
    const auto learn = [&](std::uint32_t input, const Sample& sample) {
        const Tick tick = sample.time - origin;
        observations.push_back({input, tick, tick, sample.bounds});
    };
    for (std::uint32_t i = 0; i < inputs_.size(); ++i) {
        const Column& column = inputs_[i];
        for (std::size_t k = after(column, from - 1); k < column.size() && column[k].time < before;
             ++k)
            learn(i, column[k]);
    }
    for (const auto& [input, time, _] : added_) {
        if (time < std::max(from, before)) continue; // it is among them, or before the start
        learn(input, inputs_[input][after(inputs_[input], time) - 1]);
    }
}

void Samples::rollback() noexcept {
    for (const Added& added : std::views::reverse(added_)) {
        Column& column = inputs_[added.input];
        const std::size_t place = after(column, added.time) - 1;
        if (added.before) {
            column[place] = *added.before;
        } else {
            column.erase(column.begin() + static_cast<std::ptrdiff_t>(place));
        }
    }
    waiting_.resize(waiting_.size() - added_.size());
    added_.clear();
    now_ = committed_;
    std::ranges::copy(committed_settled_, settled_.begin());
}

void Samples::commit() {
    if (now_.start) {
        for (const auto& [input, time] : waiting_) {
            Column& column = inputs_[input];
            const std::size_t place = after(column, time);
            if (place > 0 && column[place - 1].time == time) column[place - 1].collected = true;
        }
        waiting_.clear();
        many_ = 0;
    }
    keep();
}

void Samples::postpone() {
    if (waiting_.size() > many_) {
        std::erase_if(waiting_, [&](const auto& each) {
            return relative(each.second) <= settled_[each.first];
        });
        many_ = 2 * waiting_.size() + few;
    }
    keep();
}

// Drops samples that end before what is not known yet, once they are as many as the others.
void Samples::keep() {
    added_.clear();
    committed_ = now_;
    std::ranges::copy(settled_, committed_settled_.begin());
    if (!now_.start) return;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        Column& column = inputs_[i];
        const std::size_t known = after(column, absolute(settled_[i]));
        if (known > 1 && 2 * (known - 1) >= column.size()) {
            column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(known - 1));
        }
    }
}

Bounds Samples::known(std::uint32_t input, Tick time) const noexcept {
    const Column& column = inputs_[input];
    const std::size_t place = after(column, time);
    if (place == 0) return ranges_[input];
    const Sample& sample = column[place - 1];
    return sample.time == time || time <= certain(input) ? sample.bounds : ranges_[input];
}

std::optional<Tick> Samples::newest(std::uint32_t input) const noexcept {
    if (inputs_[input].empty()) return std::nullopt;
    return inputs_[input].back().time;
}

std::optional<Tick> Samples::closed() const noexcept {
    if (now_.closed == never) return std::nullopt;
    return now_.closed;
}

std::size_t Samples::bytes() const noexcept {
    std::size_t sum = 0;
    for (const Column& column : inputs_)
        sum += column.size() * sizeof(Sample);
    return sum + waiting_.size() * sizeof(waiting_[0]);
}

void Samples::transfer(Snapshot& snapshot) {
    const auto near = [](Tick time) { return time < farthest && time > -farthest; };
    snapshot.item(now_.start);
    snapshot.item(now_.newest);
    snapshot.item(now_.closed);
    snapshot.item(now_.waits);
    snapshot.require(near(now_.start.value_or(0)) && near(now_.newest.value_or(0)));
    // Lateness is counted back from the newest sample.
    snapshot.require(now_.closed == never || now_.closed == at_end ||
                     (now_.closed <= farthest && now_.closed > -farthest - forever));
    if (now_.start) {
        const Tick length = now_.newest.value_or(*now_.start - 1) - *now_.start;
        snapshot.require(length >= 0 && length < longest);
    }
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        Column& column = inputs_[i];
        std::size_t size = column.size();
        snapshot.count(size, sizeof(Tick) + sizeof(Bounds));
        column.resize(size);
        for (std::size_t k = 0; k < size; ++k) {
            snapshot.item(column[k].time);
            snapshot.item(column[k].bounds.lower);
            snapshot.item(column[k].bounds.upper);
            snapshot.require(near(column[k].time) && column[k].time <= now_.newest);
            snapshot.require(k == 0 || column[k - 1].time < column[k].time);
            snapshot.require(column[k].bounds.lower <= column[k].bounds.upper);
        }
        snapshot.item(settled_[i]);
        snapshot.require(settled_[i] >= -1 && settled_[i] <= forever);
        snapshot.require(!now_.start ||
                         (size > 0 && (settled_[i] == forever ||
                                       column.front().time <= absolute(settled_[i]) + 1)));
    }
    added_.clear();
    waiting_.clear();
    for (std::uint32_t i = 0; i < inputs_.size(); ++i) {
        for (Sample& sample : inputs_[i]) {
            sample.collected = now_.start.has_value();
            if (!now_.start) waiting_.emplace_back(i, sample.time);
        }
    }
    committed_ = now_;
    committed_settled_ = settled_;
}

} // namespace rtamt::early
