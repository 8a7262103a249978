#include "chain.hpp"

#include "strip.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rtamt::discrete {

namespace {

// NaN as an operand makes NaN of the result.
[[nodiscard]] bool passes_on(Opcode opcode) noexcept {
    switch (opcode) {
    case Opcode::min:
    case Opcode::max:
    case Opcode::holds_gt:
    case Opcode::holds_ge:
    case Opcode::holds_eq:
        return false;
    default:
        return true;
    }
}

// What a member does when the accumulator is its only or first operand, or its second one.
struct Actions {
    Action front{};
    Action back{};
    std::optional<Action> both = std::nullopt; // with neither in the accumulator
};

[[nodiscard]] Actions actions(Opcode opcode) noexcept {
    switch (opcode) {
    case Opcode::neg:
        return {Action::neg, Action::neg};
    case Opcode::abs:
        return {Action::abs, Action::abs};
    case Opcode::sqrt:
        return {Action::sqrt, Action::sqrt};
    case Opcode::add:
        return {Action::add, Action::add, Action::add_both};
    case Opcode::sub:
        return {Action::sub, Action::sub_back, Action::sub_both};
    case Opcode::mul:
        return {Action::mul, Action::mul, Action::mul_both};
    case Opcode::div:
        return {Action::div, Action::div_back};
    case Opcode::min:
        return {Action::min, Action::min_back};
    case Opcode::max:
        return {Action::max, Action::max_back};
    case Opcode::holds_gt:
        return {Action::holds_gt, Action::holds_gt_back};
    case Opcode::holds_ge:
        return {Action::holds_ge, Action::holds_ge_back};
    case Opcode::holds_eq:
        return {Action::holds_eq, Action::holds_eq};
    default:
        return {Action::at_least, Action::at_least_back};
    }
}

class Maker {
  public:
    Maker(const Program& program, const Fusion& fusion, std::span<const std::uint32_t> members)
        : program_(program), fusion_(fusion), members_(members), values_(members.size()) {
        for (const std::uint32_t member : members) {
            program.each_operand(program.instructions[member], [&](std::uint32_t operand) {
                if (Value* value = find(operand)) {
                    ++value->uses;
                    value->passed_on |= passes_on(program.instructions[member].opcode);
                } else {
                    (program.is_constant(operand) ? constants_ : code_.columns).push_back(operand);
                }
            });
        }
        for (auto* operands : {&code_.columns, &constants_}) {
            std::ranges::sort(*operands);
            operands->erase(std::ranges::unique(*operands).begin(), operands->end());
        }
        for (const std::uint32_t constant : constants_)
            code_.constants.push_back(program.instructions[constant].x);
    }

    [[nodiscard]] ChainCode make() {
        for (std::size_t i = 0; i < members_.size(); ++i) {
            const bool joined = joins_difference(i);
            compute(joined ? i + 1 : i, joined);
            i += static_cast<std::size_t>(joined);
        }
        return std::move(code_);
    }

  private:
    // A member: how often it is read, whether NaN is passed on by a reader, whether it may be NaN,
    // and where it is stored.
    struct Value {
        std::uint32_t uses = 0;
        bool passed_on = false;
        bool doubtful = false;
        std::uint32_t slot = no_operand;
    };

    const Program& program_;
    const Fusion& fusion_;
    std::span<const std::uint32_t> members_;
    ChainCode code_;
    std::vector<Value> values_;            // of the members
    std::vector<std::uint32_t> constants_; // instructions
    std::vector<std::uint32_t> free_;      // slots
    std::uint32_t held_ = no_operand;      // what the accumulator is

    // Null for what is no member.
    [[nodiscard]] Value* find(std::uint32_t instruction) noexcept {
        if (!fusion_.chained[instruction] || fusion_.roots[instruction] != members_.back()) {
            return nullptr;
        }
        return &values_[place_in(members_, instruction)];
    }

    [[nodiscard]] static std::uint32_t place_in(std::span<const std::uint32_t> sorted,
                                                std::uint32_t instruction) noexcept {
        return static_cast<std::uint32_t>(std::ranges::lower_bound(sorted, instruction) -
                                          sorted.begin());
    }

    // The number of an operand that is in memory.
    [[nodiscard]] std::uint32_t number(std::uint32_t instruction) noexcept {
        const auto columns = static_cast<std::uint32_t>(code_.columns.size());
        if (const Value* value = find(instruction)) {
            return columns + static_cast<std::uint32_t>(constants_.size()) + value->slot;
        }
        if (program_.is_constant(instruction)) return columns + place_in(constants_, instruction);
        return place_in(code_.columns, instruction);
    }

    void emit(const Step& step, std::uint32_t computes = no_operand) {
        code_.steps.push_back(step);
        code_.computes.push_back(computes);
    }

    [[nodiscard]] const Instruction& at(std::size_t place) const noexcept {
        return program_.instructions[members_[place]];
    }

    // Whether a member is a difference, of what is in memory and is never NaN, that the next one
    // joins to the one before: the bounds of x >= 1 and y <= 2, for instance.
    [[nodiscard]] bool joins_difference(std::size_t place) noexcept {
        if (place == 0 || place + 1 >= members_.size()) return false;
        const Instruction& difference = at(place);
        const Instruction& next = at(place + 1);
        return difference.opcode == Opcode::sub && values_[place].uses == 1 &&
               !program_.can_fail(difference) && find(difference.a) == nullptr &&
               find(difference.b) == nullptr &&
               (next.opcode == Opcode::min || next.opcode == Opcode::max) &&
               next.a == members_[place - 1] && next.b == members_[place];
    }

    // `joined`: with the member before, a difference.
    void compute(std::size_t place, bool joined) {
        const std::uint32_t member = members_[place];
        const Instruction& instruction = program_.instructions[member];
        const auto [front, back, both] = actions(instruction.opcode);
        const bool checked = fusion_.guarded[member] && info(instruction.opcode).partial;
        const std::uint32_t computes = checked ? member : no_operand;
        const bool binary = instruction.b != no_operand;
        if (joined) {
            const Instruction& difference = at(place - 1);
            emit({instruction.opcode == Opcode::min ? Action::min_difference
                                                    : Action::max_difference,
                  false, number(difference.a), number(difference.b)});
        } else if (held_ == instruction.a) {
            emit({front, false, binary ? number(instruction.b) : 0}, computes);
        } else if (binary && held_ == instruction.b) {
            emit({back, false, number(instruction.a)}, computes);
        } else if (both) {
            emit({*both, false, number(instruction.a), number(instruction.b)}, computes);
        } else {
            emit({Action::load, false, number(instruction.a)});
            emit({front, false, binary ? number(instruction.b) : 0}, computes);
        }
        held_ = member;
        Value& value = values_[place];
        value.doubtful = program_.can_fail(instruction);
        program_.each_operand(instruction, [&](std::uint32_t operand) {
            Value* read = find(operand);
            if (read == nullptr) return;
            value.doubtful |= read->doubtful;
            if (--read->uses == 0 && read->slot != no_operand) free_.push_back(read->slot);
        });
        code_.steps.back().checked = value.doubtful && !value.passed_on;
        std::uint32_t taken = 0; // by the next member, from the accumulator
        if (const std::size_t next_place = place + 1 + joins_difference(place + 1);
            next_place < members_.size()) {
            const Instruction& next = at(next_place);
            taken = static_cast<std::uint32_t>(next.a == member || next.b == member);
        }
        if (value.uses > taken) store(value);
    }

    void store(Value& value) {
        if (free_.empty()) free_.push_back(static_cast<std::uint32_t>(code_.stored++));
        value.slot = free_.back();
        free_.pop_back();
        emit({Action::store, false, value.slot});
    }
};

} // namespace

ChainCode chain_code(const Program& program, const Fusion& fusion,
                     std::span<const std::uint32_t> members) {
    return Maker(program, fusion, members).make();
}

Chain::Chain(ChainCode code, std::int64_t lag, std::size_t width)
    : Kernel(lag), code_(std::move(code)),
      operands_(code_.columns.size() + code_.constants.size() + code_.stored), width_(width) {
    for (std::size_t i = 0; i < code_.columns.size(); ++i)
        operands_[i].moves = ~std::size_t{0};
}

void Chain::make_room(std::size_t slots) {
    const std::size_t stride = slots * width_ < strip_width ? 1 : strip_width;
    if (stride == stride_) return;
    stride_ = stride;
    const std::size_t constants = code_.constants.size() * stride_;
    memory_.resize(constants + code_.stored * stride_);
    for (std::size_t i = 0; i < constants; ++i)
        memory_[i] = code_.constants[i / stride_];
    const std::size_t columns = code_.columns.size();
    for (std::size_t i = columns; i < operands_.size(); ++i)
        operands_[i].values = memory_.data() + (i - columns) * stride_;
}

Memory Chain::memory(std::span<const Step> steps) noexcept {
    return {steps, operands_.data(), memory_.data() + code_.constants.size() * stride_, stride_};
}

std::size_t Chain::run(const Block& block) noexcept {
    const Range present = block.present(lag());
    const std::size_t begin = present.begin * width_;
    const std::size_t end = present.end * width_;
    const Memory memory = this->memory(code_.steps);
    auto* values = out<double>();
    bool undefined = false;
    if (end - begin >= strip_width) {
        undefined = vectorised<Strips>(end - begin, memory, begin, end - begin, values);
    } else {
        for (std::size_t place = begin; place < end; ++place)
            undefined |= run_sample(memory, place, values[place]);
    }
    return undefined ? first_undefined(present) : defined;
}

std::uint32_t Chain::culprit(std::uint32_t /*root*/) const noexcept {
    return culprit_;
}

// The first slot with a member that is NaN, and of these the first one.
std::size_t Chain::first_undefined(Range range) noexcept {
    for (std::size_t slot = range.begin; slot < range.end; ++slot) {
        std::size_t first = code_.steps.size();
        for (std::size_t place = slot * width_; place < (slot + 1) * width_; ++place)
            first = std::min(first, first_undefined_step(place));
        if (first == code_.steps.size()) continue;
        culprit_ = code_.computes[first];
        return slot;
    }
    return defined;
}

std::size_t Chain::first_undefined_step(std::size_t place) noexcept {
    double value = 0.0;
    for (std::size_t i = 0; i < code_.steps.size(); ++i) {
        (void)run_sample(memory({&code_.steps[i], 1}), place, value);
        if (code_.computes[i] != no_operand && std::isnan(value)) return i;
    }
    return code_.steps.size();
}

} // namespace rtamt::discrete
