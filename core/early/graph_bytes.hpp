// Reads the graph of early verdicts from the bytes of a program, little endian:
//
//     node    u32 kind, u32 a, u32 b, i64 low, i64 high, i64 horizon, u32 number of steps; of each
//             step u32 opcode, u32 a, u32 b, f64 x
//     item    u32 kind, u32 negated, u32 a, u32 b, u32 c, i64 tick
//     cause   u32 kind, u32 ref, u32 a, u32 b, i64 low, i64 high, i64 shift, u32 core
//     start   u32 a, u32 b, u32 before, u32 rest
//
// Lengths are not trusted. References are checked by what takes the graph.
#pragma once

#include "../program/reader.hpp"
#include "bounds_at_start.hpp"
#include "causation.hpp"
#include "graph.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace rtamt::early {

class GraphReader {
  public:
    explicit GraphReader(std::span<const std::uint8_t> bytes) : reader_(bytes) {}

    [[nodiscard]] std::uint32_t number() { return take<std::uint32_t>(); }
    [[nodiscard]] Tick tick() { return std::bit_cast<Tick>(take<std::uint64_t>()); }
    [[nodiscard]] double real() { return std::bit_cast<double>(take<std::uint64_t>()); }

    // A number of records, each of at least so many bytes.
    [[nodiscard]] std::uint32_t count(std::size_t size) {
        const std::uint32_t count = number();
        require(count <= reader_.left() / size);
        return count;
    }

    [[nodiscard]] std::string text() { return reader_.text(count(1)); }

    static void require(bool holds) {
        if (!holds) {
            throw std::invalid_argument(
                "This is not a program that can be run: its graph is damaged.");
        }
    }

    [[nodiscard]] bool left() const noexcept { return reader_.left() != 0; }
    void end() const { require(!left()); }

  private:
    Reader reader_;

    template <class Unsigned>
    [[nodiscard]] Unsigned take() {
        require(sizeof(Unsigned) <= reader_.left());
        return reader_.take<Unsigned>();
    }
};

inline constexpr std::size_t node_size = 40; // without steps
inline constexpr std::size_t item_size = 28;

[[nodiscard]] inline Node read_node(GraphReader& reader) {
    Node node;
    const std::uint32_t kind = reader.number();
    GraphReader::require(kind <= static_cast<std::uint32_t>(Kind::pulses));
    node.kind = static_cast<Kind>(kind);
    node.a = reader.number();
    node.b = reader.number();
    node.low = reader.tick();
    node.high = reader.tick();
    node.horizon = reader.tick();
    GraphReader::require(node.low >= -forever && node.high <= forever && node.horizon >= 0 &&
                         node.horizon <= forever);
    const std::uint32_t steps = reader.count(20);
    for (std::uint32_t i = 0; i < steps; ++i) {
        const std::uint32_t opcode = reader.number();
        GraphReader::require(opcode < opcodes.size());
        Step step{static_cast<Opcode>(opcode), reader.number(), reader.number(), 0.0};
        step.x = reader.real();
        GraphReader::require(step.x == step.x); // no NaN
        node.steps.push_back(step);
    }
    return node;
}

[[nodiscard]] inline Item read_item(GraphReader& reader, std::size_t nodes) {
    const std::uint32_t kind = reader.number();
    GraphReader::require(kind <= static_cast<std::uint32_t>(Item::Kind::either));
    Item item;
    item.kind = static_cast<Item::Kind>(kind);
    item.negated = reader.number() != 0;
    item.a = reader.number();
    item.b = reader.number();
    item.c = reader.number();
    item.tick = reader.tick();
    if (item.kind == Item::Kind::until) {
        GraphReader::require(item.b / 2 < nodes && item.c / 2 < nodes);
    }
    return item;
}

[[nodiscard]] inline Cause read_cause(GraphReader& reader) {
    const std::uint32_t kind = reader.number();
    GraphReader::require(kind <= static_cast<std::uint32_t>(Cause::Kind::since));
    Cause cause;
    cause.kind = static_cast<Cause::Kind>(kind);
    cause.ref = reader.number();
    cause.a = reader.number();
    cause.b = reader.number();
    cause.low = reader.tick();
    cause.high = reader.tick();
    cause.shift = reader.tick();
    cause.core = reader.number();
    GraphReader::require(cause.low >= -forever && cause.high <= forever);
    return cause;
}

[[nodiscard]] inline StartingCause read_start(GraphReader& reader) {
    StartingCause start;
    start.a = reader.number();
    start.b = reader.number();
    start.before = reader.number();
    start.rest = reader.number();
    return start;
}

} // namespace rtamt::early
