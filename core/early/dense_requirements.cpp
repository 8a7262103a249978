#include "dense_requirements.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

// The number of calls between two clean-ups of what is no longer needed.
constexpr std::int64_t pause = 64;

// The minimum of several inputs, each of which is final a number of ticks after its instant.
[[nodiscard]] Graph minimum_of(std::span<const Tick> horizons) {
    Graph graph;
    graph.inputs = static_cast<std::uint32_t>(horizons.size());
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < graph.inputs; ++i) {
        Node atom{.kind = Kind::atom, .horizon = horizons[i], .steps = {}};
        atom.steps.push_back({.opcode = Opcode::input, .a = i});
        graph.nodes.push_back(std::move(atom));
        const auto ref = static_cast<std::uint32_t>(2 * (graph.nodes.size() - 1));
        if (i > 0) {
            const Tick horizon = std::max(graph.nodes[last / 2].horizon, horizons[i]);
            graph.nodes.push_back(
                {.kind = Kind::both, .a = last, .b = ref, .horizon = horizon, .steps = {}});
        }
        last = static_cast<std::uint32_t>(2 * (graph.nodes.size() - 1));
    }
    return graph;
}

} // namespace

DenseRequirements::DenseRequirements(std::vector<Group> groups, std::size_t required,
                                     const std::vector<std::vector<Place>>& outputs)
    : required_(required) {
    const auto require = [](bool holds) {
        if (!holds) throw std::invalid_argument("These are no groups of requirements.");
    };
    require(!groups.empty() && required <= groups.size());
    const bool decides = groups.front().settings.decides;
    for (Group& group : groups) {
        const auto number = static_cast<std::uint32_t>(monitors_.size());
        require(group.graph.inputs == group.inputs.size());
        for (std::uint32_t i = 0; i < group.inputs.size(); ++i) {
            if (group.inputs[i] >= homes_.size()) homes_.resize(group.inputs[i] + 1, {none, 0});
            Place& home = homes_[group.inputs[i]];
            if (home.group == none) home = {number, i};
        }
        group.settings.several = groups.size() > 1;
        // Everything that arrives before all traces have started is one event.
        group.settings.waits = group.settings.several && group.settings.causes.has_value();
        monitors_.emplace_back(std::move(group.graph), std::move(group.settings));
        inputs_.push_back(std::move(group.inputs));
    }
    require(std::ranges::none_of(homes_, [](const Place& home) { return home.group == none; }));
    std::vector<Tick> horizons;
    for (const auto& places : outputs) {
        require(places.size() == 1 || (!places.empty() && outputs_.empty()));
        for (const Place& place : places) {
            require(place.group < monitors_.size() &&
                    place.output < monitors_[place.group].outputs());
        }
        outputs_.push_back(places.front());
        if (places.size() == 1) continue;
        for (const Place& place : places) {
            const DenseMonitor& monitor = monitors_[place.group];
            horizons.push_back(monitor.engine().horizon(monitor.ref(place.output)));
        }
        BoundsEngine engine(minimum_of(horizons), {}, BoundsEngine::Arrival::pieces);
        const auto last = static_cast<std::uint32_t>(engine.size() - 1);
        DenseOutput output(2 * last, decides, engine);
        std::vector<Tick> wanted(engine.size());
        minimum_.emplace(Minimum{std::move(engine), std::move(output), places, std::move(wanted)});
    }
}

// ---- samples ------------------------------------------------------------------------------------

bool DenseRequirements::may_come(std::uint32_t input, Tick time) const noexcept {
    const auto [group, own] = homes_[input];
    return monitors_[group].samples().may_come(own, time);
}

Bounds DenseRequirements::known(std::uint32_t input, Tick time) const noexcept {
    const auto [group, own] = homes_[input];
    return monitors_[group].samples().known(own, time);
}

std::optional<Tick> DenseRequirements::newest(std::uint32_t input) const noexcept {
    const auto [group, own] = homes_[input];
    return monitors_[group].samples().newest(own);
}

// Lets every monitor stage something, and all accept it or none.
template <class Stage>
std::optional<DenseRequirements::Failure> DenseRequirements::each(const Stage& stage) {
    for (std::uint32_t group = 0; group < monitors_.size(); ++group)
        stage(group);
    if (std::ranges::all_of(monitors_, &DenseMonitor::ready))
        std::ranges::for_each(monitors_, &DenseMonitor::release);
    for (std::uint32_t group = 0; group < monitors_.size(); ++group) {
        if (const auto failure = monitors_[group].attempt()) {
            for (std::uint32_t other = 0; other < monitors_.size(); ++other) {
                if (other < group) monitors_[other].reject();
                if (other > group) monitors_[other].unstage();
            }
            return Failure{group, *failure};
        }
    }
    std::ranges::for_each(monitors_, &DenseMonitor::accept);
    return std::nullopt;
}

std::optional<DenseRequirements::Failure> DenseRequirements::take(Tick time,
                                                                  std::span<const Given> given) {
    if (monitors_.size() == 1) {
        if (const auto failure = monitors_.front().take(time, given)) return Failure{0, *failure};
        return std::nullopt;
    }
    const auto before = newest();
    const auto failure = each([&](std::uint32_t group) {
        given_.clear();
        for (const Given& value : given) {
            const auto& inputs = inputs_[group];
            const auto place = std::ranges::find(inputs, value.input);
            if (place == inputs.end()) continue;
            given_.push_back({static_cast<std::uint32_t>(place - inputs.begin()), value.bounds});
        }
        const auto seen = given.empty() ? std::nullopt : std::optional(time);
        monitors_[group].stage(time, given_, seen);
    });
    if (!failure) follow(time, before);
    return failure;
}

std::optional<DenseRequirements::Failure> DenseRequirements::watermark(Tick time) {
    const auto before = newest();
    const auto failure = each([&](std::uint32_t group) { monitors_[group].stage_watermark(time); });
    if (!failure) follow(time, before);
    return failure;
}

std::optional<DenseRequirements::Failure> DenseRequirements::finish() {
    const auto before = newest();
    const auto failure = each([&](std::uint32_t group) { monitors_[group].stage_finish(); });
    if (!failure) follow(before.value_or(0), before);
    return failure;
}

std::optional<Tick> DenseRequirements::newest() const noexcept {
    std::optional<Tick> newest;
    for (const DenseMonitor& monitor : monitors_)
        newest = std::max(newest, monitor.samples().newest()); // none is less than any
    return newest;
}

std::optional<Tick> DenseRequirements::closed() const noexcept {
    return monitors_.front().samples().closed();
}

std::optional<Tick> DenseRequirements::complete() const noexcept {
    auto complete = monitors_.front().complete();
    for (const DenseMonitor& monitor : monitors_)
        complete = std::min(complete, monitor.complete());
    return complete;
}

// ---- the minimum --------------------------------------------------------------------------------

// Hands on what all groups have learned.
void DenseRequirements::follow(Tick at, std::optional<Tick> before) {
    if (!minimum_) return;
    Minimum& own = *minimum_;
    const bool begins = !own.begun;
    if (begins) {
        Tick start = std::numeric_limits<Tick>::max();
        for (const Place& place : own.places) {
            const auto begun = monitors_[place.group].trace_start();
            if (!begun) return;
            start = std::min(start, *begun);
        }
        own.start = start;
        own.begun = true;
    }
    observations_.clear();
    for (std::uint32_t i = 0; i < own.places.size(); ++i)
        observe(i, begins);
    const Tick newest = *this->newest() - own.start;
    (void)own.engine.learn(observations_, newest, finished()); // which cannot fail
    own.output.collect(own.engine, own.start, at, begins ? -1 : *before - own.start, newest);
    if (finished() || ++own.calls % pause != 0) return;
    const auto complete = this->complete();
    if (!complete) return;
    std::ranges::fill(own.wanted, forever);
    const Tick closed = *complete - own.start;
    own.wanted.back() = own.output.settle(own.engine, closed);
    own.engine.settle(closed, own.wanted);
}

// What has changed of an operand, or all of it; before its start it is not less than any other.
void DenseRequirements::observe(std::uint32_t place, bool begins) {
    const auto [group, output] = minimum_->places[place];
    const DenseMonitor& monitor = monitors_[group];
    const std::uint32_t ref = monitor.ref(output);
    const Tick shift = *monitor.trace_start() - minimum_->start;
    const auto rise = [&](int reg, Tick l, Tick r, double value) {
        const Bounds bounds = reg == 0 ? Bounds{value, infinity} : Bounds{-infinity, -value};
        observations_.push_back({place, plus(l, shift), plus(r, shift), bounds});
    };
    if (begins && shift > 0) {
        observations_.push_back({place, 0, shift - 1, {infinity, infinity}});
    }
    for (int reg = 0; reg < 2; ++reg) {
        if (!begins) {
            for (const Piece& piece : monitor.engine().new_data(ref, reg))
                rise(reg, piece.l, piece.r, piece.now);
            continue;
        }
        for (Tick t = 0; t < forever;) {
            const Run run = monitor.engine().runs(ref, reg).at(t);
            rise(reg, t, run.end, run.value);
            t = plus(run.end, 1);
        }
    }
}

// ---- results ------------------------------------------------------------------------------------

const std::vector<Decision>& DenseRequirements::decisions(std::size_t output) const noexcept {
    if (is_minimum(output)) return minimum_->output.decisions();
    return of(output).decisions(outputs_[output].output);
}

std::vector<BoundChange> DenseRequirements::changes(std::size_t output) {
    if (!is_minimum(output)) return of(output).changes(outputs_[output].output);
    return minimum_->output.changes(minimum_->engine, minimum_->start);
}

std::vector<BoundChange> DenseRequirements::runs(std::size_t output) {
    if (!is_minimum(output)) return of(output).runs(outputs_[output].output);
    if (!minimum_->begun) return {};
    const Tick newest = *this->newest() - minimum_->start;
    return minimum_->output.runs(minimum_->engine, minimum_->start, newest);
}

std::optional<Bounds> DenseRequirements::at(std::size_t output, Tick time) {
    if (!is_minimum(output)) return of(output).at(outputs_[output].output, time);
    if (!minimum_->begun) return std::nullopt;
    return minimum_->output.at(minimum_->engine, time - minimum_->start);
}

std::optional<Tick> DenseRequirements::held(std::size_t output) const noexcept {
    if (!is_minimum(output)) return of(output).held(outputs_[output].output);
    if (!minimum_->begun) return std::nullopt;
    return minimum_->start + minimum_->output.held();
}

std::optional<Bounds> DenseRequirements::at_start() {
    std::optional<Bounds> result;
    for (std::size_t group = 0; group < required_; ++group) {
        const auto bounds = monitors_[group].at_start();
        if (!bounds) return std::nullopt;
        result = result ? Interval::meet(*result, *bounds) : *bounds;
    }
    if (!result) return std::nullopt;
    return unsigned_zeros(*result);
}

// ---- causation ----------------------------------------------------------------------------------

Bounds DenseRequirements::caused_at_start() {
    if (required_ == 1) return monitors_.front().caused_at_start();
    Bounds result = bounds::anything;
    const auto limit = at_start();
    for (std::size_t group = 0; group < required_; ++group) {
        const Bounds caused = monitors_[group].caused_at_start();
        result = {Real::join(result.lower, caused.lower), Real::meet(result.upper, caused.upper)};
    }
    return {limit ? Real::meet(result.lower, limit->lower) : result.lower, result.upper};
}

// Satisfaction and negated violation of the minimum, in its ticks.
std::array<Pieces, 2> DenseRequirements::caused_pieces() const {
    std::array<Pieces, 2> pieces;
    if (!minimum_->begun) return pieces;
    for (const Place& place : minimum_->places) {
        for (const BoundChange& run : monitors_[place.group].caused_up_to(place.output, forever)) {
            const Tick l = plus(run.l, -minimum_->start);
            const Tick r = plus(run.r, -minimum_->start);
            if (run.bounds.lower > -infinity) pieces[0].push_back({l, r, run.bounds.lower});
            if (run.bounds.upper < infinity) pieces[1].push_back({l, r, -run.bounds.upper});
        }
    }
    for (Pieces& each : pieces)
        envelope(each);
    limit(pieces[0], minimum_->engine.runs(minimum_->output.ref(), 0));
    return pieces;
}

std::optional<Bounds> DenseRequirements::caused(std::size_t output,
                                                std::optional<Tick> time) const {
    if (!is_minimum(output)) return of(output).caused(outputs_[output].output, time);
    const Tick tick = time.value_or(minimum_->start);
    if (!minimum_->begun || tick < minimum_->start) return std::nullopt;
    const auto pieces = caused_pieces();
    const Tick t = std::min(tick - minimum_->start, forever);
    return Bounds{value_at(pieces[0], t), -value_at(pieces[1], t)};
}

std::vector<BoundChange> DenseRequirements::caused(std::size_t output) const {
    if (!is_minimum(output)) return of(output).caused(outputs_[output].output);
    const Tick last = finished() ? *newest() - minimum_->start : forever;
    const auto pieces = caused_pieces();
    return timed(caused_runs(pieces[0], pieces[1], last), minimum_->start);
}

// ---- predictions --------------------------------------------------------------------------------

std::variant<std::optional<Bounds>, DenseRequirements::Failure>
DenseRequirements::suppose(std::optional<std::size_t> output, Tick time,
                           std::span<const Supposed> later) {
    const bool whole = !output || is_minimum(*output);
    std::vector<Place> places;
    if (!output) {
        for (std::uint32_t group = 0; group < required_; ++group)
            places.push_back({group, 0});
    } else if (whole) {
        places = minimum_->places;
    } else {
        places.push_back(outputs_[*output]);
    }
    if (output) {
        const auto first = held(*output);
        if (!first || time < *first) return std::nullopt;
    }
    std::optional<Bounds> result;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const auto [group, place] = places[i];
        DenseMonitor& monitor = monitors_[group];
        const auto start = monitor.trace_start();
        if (!start) return std::nullopt;
        if (output && time < *start) continue; // it does not take part yet
        Bounds value{};
        if (output && whole && time < *monitor.held(place)) { // it is final
            value = minimum_->engine.known(i, time - minimum_->start);
        } else {
            std::vector<Supposed> own;
            for (const Supposed& each : later) {
                const auto input = std::ranges::find(inputs_[group], each.input);
                if (input == inputs_[group].end()) continue;
                const auto number = static_cast<std::uint32_t>(input - inputs_[group].begin());
                own.push_back({number, each.from, each.bounds});
            }
            const auto asked = output ? std::optional<std::size_t>(place) : std::nullopt;
            const auto found = monitor.suppose(asked, time, own);
            if (const auto* failure = std::get_if<BoundsEngine::Failure>(&found)) {
                return Failure{group, *failure};
            }
            value = std::get<Bounds>(found);
        }
        result = result ? Interval::meet(*result, value) : value;
    }
    if (!result) return std::nullopt;
    return unsigned_zeros(*result);
}

// ---- state --------------------------------------------------------------------------------------

std::size_t DenseRequirements::bytes() const noexcept {
    std::size_t sum = minimum_ ? minimum_->engine.bytes() + minimum_->output.bytes() : 0;
    for (const DenseMonitor& monitor : monitors_)
        sum += monitor.bytes();
    return sum;
}

void DenseRequirements::transfer(Snapshot& snapshot) {
    for (DenseMonitor& monitor : monitors_)
        monitor.transfer(snapshot);
    if (!minimum_) return;
    minimum_->engine.transfer(snapshot);
    minimum_->output.transfer(snapshot);
    snapshot.item(minimum_->start);
    snapshot.item(minimum_->begun);
    if (!minimum_->begun) return;
    Tick start = std::numeric_limits<Tick>::max();
    for (const Place& place : minimum_->places) {
        const auto begun = monitors_[place.group].trace_start();
        snapshot.require(begun.has_value());
        start = std::min(start, begun.value_or(start));
    }
    snapshot.require(start == minimum_->start);
    snapshot.require(minimum_->engine.seen() == *newest() - start);
}

} // namespace rtamt::early
