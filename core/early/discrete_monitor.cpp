#include "discrete_monitor.hpp"

#include <algorithm>
#include <ranges>
#include <stdexcept>

namespace rtamt::early {

namespace {

// The number of samples between two clean-ups of what is no longer needed.
constexpr std::int64_t pause = 64;

} // namespace

DiscreteMonitor::DiscreteMonitor(const Graph& graph, DiscreteSettings settings)
    : outputs_(std::move(settings.outputs)), waiting_(outputs_.size()),
      reports_start_(!settings.at_start.empty()), times_(settings.period, settings.tolerance),
      ranges_(std::move(settings.ranges)), lateness_(settings.lateness), decides_(settings.decides),
      news_(outputs_.size()), changes_(outputs_.size()), open_(outputs_.size(), 0),
      kept_(outputs_.size(), 0), wanted_(graph.nodes.size()) {
    graph.check();
    ranges_.resize(graph.inputs, bounds::anything);
    if (late()) late_rows_.emplace(ranges_);
    for (const std::uint32_t output : outputs_) {
        if (output / 2 >= graph.nodes.size())
            throw std::invalid_argument("There is no such output.");
        lags_.push_back(std::max<Tick>(0, graph.nodes[output / 2].horizon));
    }
    BoundsAtStart::check(settings.at_start, graph.nodes.size());
    if (!late() && !settings.causes) { // what is late may need any tick, and so may causes
        if (decides_ && !reports_start_) {
            eager_ = EagerEngine::of(graph, ranges_);
        } else if (!decides_ && !outputs_.empty()) {
            zone_ = ZoneEngine::of(graph, outputs_, settings.at_start, ranges_, settings.zone);
        }
    }
    if (!eager_ && !zone_) follow(graph, std::move(settings));
    // Facts known before any sample, such as the truth of constants, are reported with the first.
    for (std::size_t i = 0; i < outputs_.size() && decides_; ++i)
        eager_ ? waiting_[i].begin(*eager_, outputs_[i]) : waiting_[i].begin(*engine_, outputs_[i]);
}

// Changes of bounds are propagated.
void DiscreteMonitor::follow(const Graph& graph, DiscreteSettings settings) {
    using Use = BoundsAtStart::Use;
    engine_.emplace(graph, ranges_,
                    late() ? BoundsEngine::Arrival::late_rows : BoundsEngine::Arrival::rows);
    if (reports_start_) {
        const Use use = settings.causes ? Use::as_given : late() ? Use::late : Use::in_order;
        at_start_.emplace(std::move(settings.at_start), *engine_, outputs_, use);
    }
    if (settings.causes) { // which are of every value, needed or not
        causes_.emplace(std::move(*settings.causes), *engine_, at_start_.value(), false);
        return;
    }
    std::vector<Tick> last(graph.nodes.size(), -1);
    for (const std::uint32_t output : outputs_)
        last[output / 2] = forever;
    if (at_start_) at_start_->limit(last);
    engine_->limit(last);
    postpones_ = late() && !decides_;
    for (std::uint32_t input = 0; input < graph.inputs; ++input)
        every_input_.push_back(input);
}

// ---- samples ------------------------------------------------------------------------------------

bool DiscreteMonitor::begin_at(Tick index) noexcept {
    if (!late() || times_.newest() >= 0 || engine_->reads_start()) return false;
    times_.begin_at(index);
    first_ = index;
    return true;
}

bool DiscreteMonitor::in_order(Tick index) const noexcept {
    const Tick newest = times_.newest();
    return newest < 0 || index == newest + 1 || (index > newest && index - 1 <= closed_);
}

template <class Value>
std::optional<DiscreteMonitor::Failure> DiscreteMonitor::row(Tick index, double time,
                                                             std::span<const Value> row) {
    auto failure = eager_  ? eager_->row(index, row)
                   : zone_ ? zone_->row(index, row)
                           : engine_->row(index, row);
    if (failure) return failure;
    advance(index, time);
    return std::nullopt;
}

template std::optional<DiscreteMonitor::Failure> DiscreteMonitor::row(Tick index, double time,
                                                                      std::span<const double> row);
template std::optional<DiscreteMonitor::Failure> DiscreteMonitor::row(Tick index, double time,
                                                                      std::span<const Bounds> row);

Tick DiscreteMonitor::closed_after(Tick index) const noexcept {
    const Tick newest = std::max(times_.newest(), index);
    return std::max(closed_, late() ? newest - *lateness_ - 1 : newest);
}

std::optional<DiscreteMonitor::Failure> DiscreteMonitor::watermark(double time) {
    if (times_.newest() < 0) return std::nullopt;
    const Tick floor = times_.floor(time);
    if (floor <= closed_) return std::nullopt;
    catch_up();
    if (late()) {
        if (auto failure = engine_->close_inputs(floor)) return failure;
    }
    closed_ = floor;
    settle();
    return std::nullopt;
}

// The engine has taken a sample.
void DiscreteMonitor::advance(Tick index, double time, bool later) {
    const Tick before = times_.newest();
    if (index > before) times_.add(index, time);
    ++samples_;
    closed_ = closed_after(index);
    before_ = before;
    later ? take_closed() : note();
    if (samples_ % pause == 0) tidy();
}

// Reads what the last change of the engine has changed up to the newest sample.
void DiscreteMonitor::note() {
    if (zone_) return; // it provides the changes
    const Tick newest = times_.newest();
    for (std::size_t i = 0; decides_ && i < outputs_.size(); ++i) {
        news_[i].clear();
        if (eager_) {
            waiting_[i].collect(*eager_, outputs_[i], newest, newest, news_[i]);
        } else {
            waiting_[i].collect(*engine_, outputs_[i], newest, newest, news_[i]);
        }
        if (news_[i].size() > 1) std::ranges::sort(news_[i], {}, &Decision::l);
    }
    unread_ = !decides_;
    if (at_start_) at_start_->read(*engine_, final_up_to());
    if (causes_) causes_->read(*engine_, *at_start_, newest);
}

// What the engine keeps until its next change, which few ask for.
void DiscreteMonitor::read_changes() const {
    catch_up();
    if (!unread_) return;
    unread_ = false;
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        changes_[i].collect(*engine_, outputs_[i], before_, times_.newest());
}

Tick DiscreteMonitor::lag(std::size_t output) const noexcept {
    return lags_[output];
}

// What is missing behind the newest sample cuts windows if the trace ends now.
Tick DiscreteMonitor::final_up_to() const noexcept {
    return std::min(closed_, times_.newest());
}

void DiscreteMonitor::settle() {
    catch_up();
    tidy();
}

// Postponed samples stay so.
void DiscreteMonitor::tidy() {
    const bool behind = !postponed_.empty();
    if (behind) { // what others changed is out of date
        std::ranges::fill(changes_, BoundChanges{});
    } else {
        read_changes();
    }
    std::ranges::fill(wanted_, forever);
    const Tick closed = behind ? std::min(closed_, engine_->seen()) : final_up_to();
    Tick oldest = closed;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Tick& wanted = wanted_[outputs_[i] / 2];
        Tick from = 0;
        if (decides_) {
            open_[i] = eager_ ? EagerVerdicts::open(*eager_, outputs_[i], open_[i])
                              : EagerVerdicts::open(*engine_, outputs_[i], open_[i]);
            from = std::max(plus(closed + 1, -lag(i)), open_[i]);
            oldest = std::min({oldest, waiting_[i].oldest(), oldest_of(news_[i])});
        } else {
            from = std::min(held(i, closed), zone_ ? zone_->first_change(i) : changes_[i].first());
            if (behind) from = std::max<Tick>(0, std::min(from, before_ + 1));
            from = kept_[i] = std::max(kept_[i], from);
            if (zone_) zone_->drop_before(i, from);
        }
        wanted = std::min(wanted, from);
        oldest = std::min(oldest, wanted);
    }
    times_.drop_before(oldest);
    if (late_rows_) late_rows_->drop_before(closed_ + 1);
    if (eager_) eager_->settle(closed, wanted_);
    if (!engine_) return;
    if (at_start_) at_start_->settle(*engine_, closed, wanted_);
    if (causes_) causes_->settle(*engine_, closed, wanted_);
    engine_->settle(closed, wanted_);
}

std::variant<DiscreteMonitor::End, DiscreteMonitor::Failure> DiscreteMonitor::finish() {
    const Tick end = times_.newest() + 1;
    catch_up();
    std::optional<Failure> failure;
    const auto zone = zone_ ? std::optional(zone_->ended()) : std::nullopt;
    std::vector<BoundsEngine::Rest> rests;
    if (eager_) {
        rests = eager_->ended(outputs_, end);
    } else if (!zone) {
        rests = engine_->ended(outputs_, end, &failure);
    }
    if (failure) return *failure;
    for (std::size_t i = 0; i < rests.size() && !decides_; ++i) {
        if (rests[i].first > std::min(kept_[i], end)) // after a forged state alone
            throw std::invalid_argument("This is not the state of a monitor of this program: it "
                                        "has no values where the end of the trace reads some.");
    }
    End last;
    finished_ = true;
    if (decides_) {
        decide_rest(rests, end);
        return last;
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const Tick first = std::min(kept_[i], end);
        Rest& rest = last.outputs.emplace_back(Rest{first, {}});
        const auto add = [&](const Bounds& each) { rest.bounds.push_back(unsigned_zeros(each)); };
        if (zone) {
            std::ranges::for_each(zone->all_from(i, first), add);
        } else {
            std::ranges::for_each(rests[i].bounds | std::views::drop(first - rests[i].first), add);
        }
    }
    if (reports_start_ && end > 0) {
        last.at_start = unsigned_zeros(zone ? zone->at_start() : at_start_->ended(*engine_, end));
    }
    return last;
}

// Decides what was open when the trace ended.
void DiscreteMonitor::decide_rest(std::span<const BoundsEngine::Rest> rests, Tick end) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        news_[i].clear();
        const BoundsEngine::Rest& rest = rests[i];
        for (Tick t = std::max(rest.first, open_[i]); t < end; ++t) {
            const Bounds was = followed(i, t);
            const Bounds now = rest.bounds[static_cast<std::size_t>(t - rest.first)];
            if (was.lower > 0 || was.upper < 0) continue;
            if (now.lower > 0) news_[i].push_back({t, t, end - 1, true});
            if (now.upper < 0) news_[i].push_back({t, t, end - 1, false});
        }
    }
}

// ---- results ------------------------------------------------------------------------------------

std::optional<Bounds> DiscreteMonitor::at_start() const {
    if (!reports_start_) return std::nullopt;
    catch_up();
    return unsigned_zeros(zone_ ? zone_->at_start() : at_start_->value());
}

std::optional<Bounds> DiscreteMonitor::bounds(std::size_t output, Tick sample) const {
    if (sample < held(output)) return std::nullopt;
    catch_up();
    return unsigned_zeros(zone_ ? zone_->at(output, sample) : followed(output, sample));
}

Bounds DiscreteMonitor::followed(std::size_t output, Tick sample) const noexcept {
    return eager_ ? eager_->bounds(outputs_[output], sample)
                  : engine_->at(outputs_[output], sample);
}

Tick DiscreteMonitor::held(std::size_t output) const noexcept {
    return held(output, final_up_to());
}

Tick DiscreteMonitor::held(std::size_t output, Tick closed) const noexcept {
    return std::max<Tick>(0, plus(closed + 1, -lag(output)) - 1);
}

std::vector<BoundChange> DiscreteMonitor::changes(std::size_t output) const {
    if (decides_) return {};
    read_changes();
    auto found = zone_ ? zone_->changes(output) : changes_[output].runs(*engine_, outputs_[output]);
    for (BoundChange& run : found)
        run.bounds = unsigned_zeros(run.bounds);
    return found;
}

bool DiscreteMonitor::is_final(std::size_t output, const BoundChange& run) const noexcept {
    return finished_ || run.bounds.lower == run.bounds.upper ||
           run.r <= plus(final_up_to(), -lag(output));
}

Bounds DiscreteMonitor::caused_at_start() const noexcept {
    return causes_ ? causes_->at_start() : bounds::anything;
}

Bounds DiscreteMonitor::caused(std::size_t output, Tick sample) const {
    return causes_.value().at(output, sample);
}

std::vector<BoundChange> DiscreteMonitor::caused(std::size_t output) const {
    return causes_.value().runs(output, finished_ ? times_.newest() : forever);
}

std::variant<Bounds, DiscreteMonitor::Failure>
DiscreteMonitor::supposed(std::optional<std::size_t> output, Tick sample,
                          std::span<const Supposition> suppositions) {
    if (zone_) {
        const ZoneEngine zone = zone_->supposed(suppositions);
        return unsigned_zeros(output ? zone.at(*output, sample) : zone.at_start());
    }
    if (eager_) throw std::invalid_argument("A monitor of verdicts supposes nothing.");
    catch_up();
    if (const auto failure = engine_->suppose(suppositions)) return *failure;
    Bounds value{};
    if (output) {
        value = engine_->at(outputs_[*output], sample);
    } else {
        BoundsAtStart at_start = at_start_.value();
        at_start.read(*engine_);
        value = at_start.value();
    }
    engine_->revert();
    return unsigned_zeros(value);
}

std::size_t DiscreteMonitor::bytes() const noexcept {
    std::size_t sum = times_.bytes() + postponed_.bytes();
    if (zone_) sum += zone_->bytes();
    if (eager_) sum += eager_->bytes();
    if (engine_) sum += engine_->bytes();
    if (late_rows_) sum += late_rows_->bytes();
    for (const EagerVerdicts& waiting : waiting_)
        sum += waiting.bytes();
    return sum;
}

// ---- state --------------------------------------------------------------------------------------

void DiscreteMonitor::transfer(Snapshot& snapshot) {
    if (snapshot.loading()) {
        unread_ = false;
        postponed_.clear();
    } else {
        read_changes();
    }
    if (zone_) {
        zone_->transfer(snapshot);
    } else if (eager_) {
        eager_->transfer(snapshot);
    } else {
        engine_->transfer(snapshot);
        if (at_start_) at_start_->transfer(snapshot);
    }
    if (causes_) causes_->transfer(snapshot);
    for (EagerVerdicts& waiting : waiting_)
        waiting.transfer(snapshot);
    for (BoundChanges& changes : changes_)
        changes.transfer(snapshot);
    times_.transfer(snapshot);
    if (late_rows_) late_rows_->transfer(snapshot);
    for (std::vector<Decision>& news : news_) {
        Tick end = 0;
        early::transfer(snapshot, news, [&](Decision& decision) {
            checked::run(snapshot, decision.l, decision.r, end);
        });
        for (const Decision& decision : news)
            snapshot.require(decision.r <= times_.newest() && decision.at <= times_.newest());
    }
    for (Tick& open : open_)
        checked::tick_or_forever(snapshot, open);
    for (Tick& kept : kept_)
        checked::tick(snapshot, kept);
    checked::tick(snapshot, closed_, -1);
    checked::tick(snapshot, samples_);
    snapshot.item(finished_);
    if (times_.newest() < 0) {
        snapshot.require(samples_ == 0 && closed_ < 0);
    } else {
        snapshot.require(samples_ > 0 && closed_ == closed_after(times_.newest()));
    }
    // What counts samples counts the same ones.
    if (engine_) snapshot.require(times_.newest() == engine_->seen());
    if (zone_) snapshot.require(times_.newest() == zone_->newest());
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        snapshot.require(kept_[i] <= held(i));
}

} // namespace rtamt::early
