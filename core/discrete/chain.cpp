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

// What computes a term: alone, or joined to the accumulator.
struct Term {
    Action alone;
    Action min;
    Action max;
};

constexpr Term difference{Action::sub_both, Action::min_difference, Action::max_difference};

// The terms of a limit: of the sum or the difference of two operands, and on which side it lies.
struct LimitTerm {
    Opcode inner;
    bool under;
    Term term;
};

constexpr LimitTerm limit_terms[] = {
    {Opcode::add, false, {Action::sum_over, Action::min_sum_over, Action::max_sum_over}},
    {Opcode::add, true, {Action::sum_under, Action::min_sum_under, Action::max_sum_under}},
    {Opcode::sub,
     false,
     {Action::difference_over, Action::min_difference_over, Action::max_difference_over}},
    {Opcode::sub,
     true,
     {Action::difference_under, Action::min_difference_under, Action::max_difference_under}},
};

class Maker {
  public:
    Maker(const Program& program, const Fusion& fusion, std::span<const std::uint32_t> members,
          bool terms)
        : program_(program), fusion_(fusion), members_(members), terms_(terms),
          values_(members.size()) {
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
        for (std::size_t i = 0; i < members_.size();)
            i += compute(i);
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
    bool terms_; // whether members are grouped
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

    // Members that are computed in one step: one, or those of a term and what joins it to the
    // member before.
    struct Group {
        std::size_t size = 1;
        std::optional<Action> action = std::nullopt; // of a term
        bool joined = false;
        std::uint32_t limit = no_operand;

        // Whether it looks for NaN in the term and in what this is joined to.
        [[nodiscard]] bool checks() const noexcept { return joined && limit != no_operand; }
    };

    // Whether the member after this one reads it, and nothing else does.
    [[nodiscard]] bool read_next(std::size_t place) const noexcept {
        if (place + 1 >= members_.size() || values_[place].uses != 1) return false;
        return at(place + 1).a == members_[place] || at(place + 1).b == members_[place];
    }

    // The bounds of x >= 1 and a + b <= 2, for instance, are a difference, and a term that is
    // joined to it.
    [[nodiscard]] Group group_at(std::size_t place) noexcept {
        const Instruction& inner = at(place);
        if (!terms_ || (inner.opcode != Opcode::add && inner.opcode != Opcode::sub) ||
            find(inner.a) != nullptr || find(inner.b) != nullptr) {
            return {};
        }
        const bool columns = !program_.is_constant(inner.a) && !program_.is_constant(inner.b);
        if (columns && read_next(place) && at(place + 1).opcode == Opcode::sub) {
            const Instruction& outer = at(place + 1);
            const bool under = outer.b == members_[place];
            const std::uint32_t limit = under ? outer.a : outer.b;
            for (const LimitTerm& each : limit_terms) {
                if (each.inner == inner.opcode && each.under == under &&
                    program_.is_constant(limit)) {
                    return joined(place, {2, each.term.alone, false, limit}, each.term);
                }
            }
        }
        if (inner.opcode != Opcode::sub || program_.can_fail(inner)) return {};
        const Group group = joined(place, {1, difference.alone}, difference);
        return group.joined ? group : Group{};
    }

    // A group with the member after it, if that joins the group to the member before.
    [[nodiscard]] Group joined(std::size_t place, const Group& group,
                               const Term& term) const noexcept {
        const std::size_t last = place + group.size - 1;
        if (place == 0 || !read_next(last)) return group;
        const Instruction& next = at(last + 1);
        if (next.a != members_[place - 1] || next.b != members_[last]) return group;
        if (next.opcode == Opcode::min) return {group.size + 1, term.min, true, group.limit};
        if (next.opcode == Opcode::max) return {group.size + 1, term.max, true, group.limit};
        return group;
    }

    // Computes the group that begins at a place; returns its size.
    std::size_t compute(std::size_t place) {
        const Group group = group_at(place);
        const std::size_t last = place + group.size - 1;
        const std::uint32_t member = members_[last];
        const Instruction& instruction = program_.instructions[member];
        if (group.action) {
            const Instruction& inner = at(place);
            emit({*group.action, false, number(inner.a), number(inner.b),
                  group.limit == no_operand ? 0 : number(group.limit)});
        } else {
            compute_alone(member);
        }
        held_ = member;
        Value& value = values_[last];
        value.doubtful =
            !group.checks() && (program_.can_fail(at(place)) || program_.can_fail(instruction));
        program_.each_operand(instruction, [&](std::uint32_t operand) {
            Value* read = find(operand);
            if (read == nullptr) return;
            value.doubtful |= read->doubtful;
            if (--read->uses == 0 && read->slot != no_operand) free_.push_back(read->slot);
        });
        const std::size_t next_place = last + 1;
        const Group next = next_place < members_.size() ? group_at(next_place) : Group{};
        if (next.checks() || !value.passed_on) {
            code_.steps.back().checked = value.doubtful && !next.checks();
            value.doubtful = false;
        }
        std::uint32_t taken = 0; // by the next group, from the accumulator
        if (next_place < members_.size()) {
            const Instruction& reader = at(next_place + (next.joined ? next.size - 1 : 0));
            taken = static_cast<std::uint32_t>(reader.a == member || reader.b == member);
        }
        if (value.uses > taken) store(value);
        return group.size;
    }

    void compute_alone(std::uint32_t member) {
        const Instruction& instruction = program_.instructions[member];
        const auto [front, back, both] = actions(instruction.opcode);
        const bool checked = fusion_.guarded[member] && info(instruction.opcode).partial;
        const std::uint32_t computes = checked ? member : no_operand;
        const bool binary = instruction.b != no_operand;
        if (held_ == instruction.a) {
            emit({front, false, binary ? number(instruction.b) : 0}, computes);
        } else if (binary && held_ == instruction.b) {
            emit({back, false, number(instruction.a)}, computes);
        } else if (both) {
            emit({*both, false, number(instruction.a), number(instruction.b)}, computes);
        } else {
            emit({Action::load, false, number(instruction.a)});
            emit({front, false, binary ? number(instruction.b) : 0}, computes);
        }
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
    ChainCode code = Maker(program, fusion, members, true).make();
    ChainCode single = Maker(program, fusion, members, false).make();
    const auto may_fail = [](std::uint32_t computed) { return computed != no_operand; };
    code.computes.clear();
    if (std::ranges::any_of(single.computes, may_fail)) {
        code.single_steps = std::move(single.steps);
        code.computes = std::move(single.computes);
        code.stored = std::max(code.stored, single.stored);
    }
    return code;
}

Chain::Chain(ChainCode code, std::int64_t lag, std::size_t width)
    : Kernel(lag), code_(std::move(code)),
      operands_(code_.columns.size() + code_.constants.size() + code_.stored),
      moves_(operands_.size()), width_(width) {
    std::fill_n(moves_.begin(), code_.columns.size(), ~std::size_t{0});
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
        operands_[i] = memory_.data() + (i - columns) * stride_;
}

Memory Chain::memory(std::span<const Step> steps) noexcept {
    return {steps, operands_.data(), moves_.data(),
            memory_.data() + code_.constants.size() * stride_, stride_};
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
        std::size_t first = code_.single_steps.size();
        for (std::size_t place = slot * width_; place < (slot + 1) * width_; ++place)
            first = std::min(first, first_undefined_step(place));
        if (first == code_.single_steps.size()) continue;
        culprit_ = code_.computes[first];
        return slot;
    }
    return defined;
}

std::size_t Chain::first_undefined_step(std::size_t place) noexcept {
    double value = 0.0;
    for (std::size_t i = 0; i < code_.single_steps.size(); ++i) {
        (void)run_sample(memory({&code_.single_steps[i], 1}), place, value);
        if (code_.computes[i] != no_operand && std::isnan(value)) return i;
    }
    return code_.single_steps.size();
}

} // namespace rtamt::discrete
