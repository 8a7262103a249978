#include "truth_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace rtamt {

namespace {

[[nodiscard]] bool is_predicate(const Instruction& instruction) noexcept {
    return instruction.opcode == Opcode::holds_gt || instruction.opcode == Opcode::holds_ge ||
           instruction.opcode == Opcode::holds_eq;
}

// Copies instructions of one program to another, and keeps their new places.
class Copier {
  public:
    Copier(const Program& from, Program& to)
        : from_(from), to_(to), places_(from.instructions.size(), no_operand) {}

    [[nodiscard]] std::uint32_t place(std::uint32_t index) const noexcept { return places_[index]; }

    void copy(std::uint32_t index) {
        Instruction instruction = from_.instructions[index];
        for (std::uint32_t* operand : {&instruction.a, &instruction.b}) {
            if (*operand != no_operand) *operand = places_[*operand];
        }
        put(index, instruction);
    }
    void put(std::uint32_t index, const Instruction& instruction) {
        places_[index] = static_cast<std::uint32_t>(to_.instructions.size());
        to_.instructions.push_back(instruction);
    }

  private:
    const Program& from_;
    Program& to_;
    std::vector<std::uint32_t> places_;
};

// The parts of a stage, by instruction.
struct Parts {
    std::vector<bool> numbers; // a predicate, or what one is computed from
    std::vector<bool> joined;  // read as a truth value

    explicit Parts(const Program& program)
        : numbers(program.instructions.size()), joined(program.instructions.size()) {
        for (const std::uint32_t output : program.outputs)
            joined[output] = true;
        for (std::size_t i = joined.size(); i-- > 0;) {
            const bool predicate = is_predicate(program.instructions[i]);
            if (joined[i] && predicate) numbers[i] = true;
            program.each_operand(program.instructions[i], [&](std::uint32_t operand) {
                if (numbers[i]) numbers[operand] = true;
                if (joined[i] && !predicate) joined[operand] = true;
            });
        }
    }
};

class Splitter {
  public:
    Splitter(std::span<const Stage> stages, std::size_t variables)
        : stages_(stages), variables_(variables) {
        for (const Stage& stage : stages)
            parts_.emplace_back(stage.program);
    }

    [[nodiscard]] bool possible() const {
        for (std::size_t i = 0; i < stages_.size(); ++i) {
            if (!stages_[i].program.calls.empty() || !gives_truths(stages_[i]) ||
                counts_scans(stages_[i], parts_[i]))
                return false;
        }
        return true;
    }

    [[nodiscard]] TruthPlan plan() {
        TruthPlan plan;
        plan.numbers.inputs = static_cast<std::uint32_t>(variables_);
        std::size_t predicates = 0;
        for (std::size_t i = 0; i < stages_.size(); ++i) {
            for (std::size_t k = 0; k < parts_[i].joined.size(); ++k)
                predicates +=
                    parts_[i].joined[k] && is_predicate(stages_[i].program.instructions[k]);
        }
        for (std::size_t i = 0; i < stages_.size(); ++i)
            add(stages_[i], parts_[i], predicates, plan);
        plan.pointwise = std::ranges::all_of(plan.numbers.instructions, [](const Instruction& at) {
            return at.opcode == Opcode::input || at.opcode == Opcode::constant ||
                   info(at.opcode).pointwise;
        });
        return plan;
    }

  private:
    std::span<const Stage> stages_;
    std::size_t variables_;
    std::vector<Parts> parts_;

    [[nodiscard]] static std::size_t column(const Stage& stage, const Instruction& input) noexcept {
        return stage.columns[static_cast<std::size_t>(input.n)];
    }

    // Whether the outputs are truth values, given that those of the stages before are.
    [[nodiscard]] bool gives_truths(const Stage& stage) const {
        Program program = stage.program;
        for (Instruction& instruction : program.instructions) {
            instruction.truth = instruction.opcode == Opcode::input
                                    ? column(stage, instruction) >= variables_
                                    : program.is_truth(instruction);
        }
        return std::ranges::all_of(program.outputs, [&](std::uint32_t output) {
            return program.instructions[output].truth;
        });
    }

    // Whether a number is computed from a scan.
    [[nodiscard]] bool counts_scans(const Stage& stage, const Parts& parts) const {
        for (std::size_t i = 0; i < parts.numbers.size(); ++i) {
            const Instruction& instruction = stage.program.instructions[i];
            if (parts.numbers[i] && instruction.opcode == Opcode::input &&
                column(stage, instruction) >= variables_)
                return true;
        }
        return false;
    }

    void add(const Stage& stage, const Parts& parts, std::size_t predicates,
             TruthPlan& plan) const {
        const Program& program = stage.program;
        Stage rest{{}, {}, stage.scans};
        Copier numbers(program, plan.numbers);
        Copier joined(program, rest.program);
        const auto read = [&](std::uint32_t i, std::size_t column) {
            const auto input = static_cast<std::int64_t>(rest.columns.size());
            joined.put(i, {Opcode::input, no_operand, no_operand, input, 0, 0});
            rest.columns.push_back(column);
        };
        for (std::uint32_t i = 0; i < program.instructions.size(); ++i) {
            const Instruction& instruction = program.instructions[i];
            if (parts.numbers[i]) {
                numbers.copy(i);
                if (instruction.opcode == Opcode::input) {
                    plan.numbers.instructions.back().n =
                        static_cast<std::int64_t>(column(stage, instruction));
                }
            }
            if (!parts.joined[i]) continue;
            if (is_predicate(instruction)) {
                read(i, plan.numbers.outputs.size());
                plan.numbers.outputs.push_back(numbers.place(i));
                if (instruction.lag != 0) { // outputs come without it
                    joined.put(i, {Opcode::shift, joined.place(i), no_operand, instruction.lag, 0,
                                   instruction.lag});
                }
            } else if (instruction.opcode == Opcode::input) {
                read(i, column(stage, instruction) - variables_ + predicates);
            } else {
                joined.copy(i);
            }
        }
        rest.program.inputs = static_cast<std::uint32_t>(rest.columns.size());
        for (const std::uint32_t output : program.outputs)
            rest.program.outputs.push_back(joined.place(output));
        plan.joined.push_back(std::move(rest));
    }
};

} // namespace

std::optional<TruthPlan> truth_plan(std::span<const Stage> stages, std::size_t variables) {
    Splitter splitter(stages, variables);
    if (!splitter.possible()) return std::nullopt;
    return splitter.plan();
}

} // namespace rtamt
