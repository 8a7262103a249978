#include "key_monitor.hpp"

#include "../values/ticks.hpp"

#include <cmath>
#include <cstdio>

namespace rtamt::fleet {

std::unique_ptr<KeyMonitor> make_monitor(const MonitorProgram& program) {
    if (program.mode == MonitorProgram::Mode::delayed) return make_dense_delayed(program);
    if (program.domain == Domain::dense) return make_dense_early(program);
    return make_discrete_early(program);
}

AtStart KeyMonitor::watermark(double /*time*/, std::size_t /*index*/, std::vector<Row>& /*rows*/) {
    throw std::invalid_argument("The monitors of this fleet have no watermark: that of interval "
                                "verdicts, and of causation in dense time, have one.");
}

std::string shown(double number) {
    char text[32];
    (void)std::snprintf(text, sizeof text, "%.15g", number);
    return text;
}

std::string shown(const Bounds& bounds) {
    if (bounds.lower == bounds.upper) return shown(bounds.lower);
    return "[" + shown(bounds.lower) + ", " + shown(bounds.upper) + "]";
}

void check_time(double time) {
    if (!std::isfinite(time)) {
        throw WrongSample("has the time " + shown(time) + " s: give a finite number of seconds.");
    }
    if (!(std::fabs(time) < ticks::implausible)) {
        throw WrongSample("has the time " + shown(time) +
                          " s, which is no time in seconds: divide it, if it is in another unit.");
    }
}

void check_value(const MonitorProgram& program, std::size_t input, const Bounds& value,
                 double time) {
    const MonitorProgram::Input& of = program.inputs[input];
    const std::string at = " at " + shown(time) + " s";
    if (std::isnan(value.lower) || std::isnan(value.upper)) {
        throw WrongSample("has NaN as '" + of.name + "'" + at + ": leave the sample out.");
    }
    const std::string what = "has " + shown(value) + " as '" + of.name + "'" + at;
    if (value.lower > value.upper) {
        throw WrongSample(what + ", reversed: give the lower bound first.");
    }
    const auto is_truth = [](double x) { return x == 0.0 || x == 1.0; };
    if (of.boolean && !(is_truth(value.lower) && is_truth(value.upper))) {
        throw WrongSample(what + ", which is Boolean: give 0 or 1.");
    }
    if (value.lower < of.range.lower || value.upper > of.range.upper) {
        throw WrongSample(what + ", outside its declared range [" + shown(of.range.lower) + ", " +
                          shown(of.range.upper) +
                          "]: correct the value, or declare a wider range.");
    }
    if (program.mode == MonitorProgram::Mode::causation && value.lower != value.upper) {
        throw WrongSample(what + ", and causation needs exact samples: give a number.");
    }
}

void not_later(double time, double last) {
    throw WrongSample("has a sample at " + shown(time) + " s, which is not after the one at " +
                      shown(last) + " s.");
}

void has_no_value(const MonitorProgram& program, std::uint32_t step, double time) {
    throw WrongSample("has no value of " + program.meaning(step) + " at " + shown(time) +
                          " s: it is 0/0, inf - inf, 0 * inf, or a function outside its domain.",
                      true);
}

bool narrows(const MonitorProgram& program, std::size_t input, const Bounds& value,
             const Bounds& known, double time) {
    if (known.lower <= value.lower && value.upper <= known.upper) return true;
    const Bounds& range = program.inputs[input].range;
    const bool is_range = known.lower == range.lower && known.upper == range.upper;
    // Less precise than what is known.
    if (value.lower <= known.lower && known.upper <= value.upper && !is_range) return false;
    throw WrongSample("has " + shown(value) + " as '" + program.inputs[input].name + "' at " +
                      shown(time) + " s, which contradicts what was known of it, " + shown(known) +
                      ": correct it.");
}

} // namespace rtamt::fleet
