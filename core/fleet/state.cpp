// The state of a fleet as bytes (docs/reference/fleet-state.md), and back.
//
// The bytes may come from anywhere: every number that is used to find memory is checked, and what a
// kernel relies upon is checked by it.
#include "../discrete/undefined.hpp"
#include "../program/crc32.hpp"
#include "fleet.hpp"
#include "state_bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace rtamt::fleet {

namespace {

constexpr std::string_view magic = "RTAMTFLT";
constexpr std::uint16_t version = 1;
constexpr std::size_t header_size = 80;
constexpr std::size_t part_size = 32;
constexpr std::size_t checksum_size = 4;

// What the header and the table of parts contain.
struct Stored {
    struct Part {
        std::uint64_t hash;
        std::uint64_t head;
        std::uint64_t tail;
        std::uint32_t head_size;
        std::uint32_t tail_size;
    };
    KeyKind kind{};
    bool clocked = false;
    bool warming = false;
    std::uint64_t record_size = 0;
    std::uint64_t count = 0;
    std::uint64_t capacity = 0;
    double period = 0.0;
    std::uint64_t times = 0;
    std::uint64_t ring = 0;
    std::uint64_t exact = 0;
    std::vector<Part> parts;

    [[nodiscard]] bool fits(std::uint64_t offset, std::uint64_t size) const noexcept {
        return offset % 8 == 0 && offset <= record_size && size <= record_size - offset;
    }
};

[[nodiscard]] Stored read_header(Bytes& bytes) {
    Stored stored;
    const auto name = bytes.take(magic.size());
    if (!std::equal(name.begin(), name.end(), magic.begin())) {
        refuse("it does not begin with \"" + std::string(magic) + "\"");
    }
    if (const auto found = bytes.take<std::uint16_t>(); found != version) {
        refuse("its format has version " + std::to_string(found) + ", and this is for version " +
               std::to_string(version));
    }
    if (const auto found = bytes.take<std::uint16_t>(); found != state_version) {
        refuse("its records have version " + std::to_string(found) + ", and this is for version " +
               std::to_string(state_version));
    }
    const auto kind = bytes.take<std::uint8_t>();
    const auto flags = bytes.take<std::uint8_t>();
    const auto reserved = bytes.take<std::uint16_t>();
    const auto parts = bytes.take<std::uint32_t>();
    const auto more_reserved = bytes.take<std::uint32_t>();
    if (kind > 3 || flags > 3 || (reserved | more_reserved) != 0)
        refuse("its header has an unknown value");
    stored.kind = static_cast<KeyKind>(kind);
    stored.clocked = (flags & 1U) != 0;
    stored.warming = (flags & 2U) != 0;
    stored.record_size = bytes.take<std::uint64_t>();
    stored.count = bytes.take<std::uint64_t>();
    stored.capacity = bytes.take<std::uint64_t>();
    stored.period = bytes.take<double>();
    stored.times = bytes.take<std::uint64_t>();
    stored.ring = bytes.take<std::uint64_t>();
    stored.exact = bytes.take<std::uint64_t>();
    if (stored.record_size < sizeof(Header) || stored.record_size % 8 != 0 ||
        stored.count > bytes.left() / stored.record_size || parts > bytes.left() / part_size) {
        refuse("its header promises more than there is");
    }
    for (std::uint32_t i = 0; i < parts; ++i)
        stored.parts.push_back(bytes.take<Stored::Part>());
    const bool clock =
        !stored.clocked || (stored.times != 0 && stored.times <= stored.record_size &&
                            stored.fits(stored.ring, stored.times * 8) &&
                            stored.record_size >= sizeof(Header) + sizeof(ClockState));
    const bool sized = std::ranges::all_of(stored.parts, [&](const Stored::Part& part) {
        return stored.fits(part.head, part.head_size) && stored.fits(part.tail, part.tail_size);
    });
    const bool exact = !stored.warming || stored.fits(stored.exact, 8 * (std::uint64_t{parts} + 1));
    if (!clock || !sized || !exact) refuse("its records are not as its header promises");
    if (stored.kind == KeyKind::none && stored.count != 0) refuse("it has no keys");
    return stored;
}

template <class Value>
[[nodiscard]] Value read_at(const std::byte* memory, std::uint64_t offset) noexcept {
    Value value{};
    std::memcpy(&value, memory + offset, sizeof(Value));
    return value;
}

} // namespace

std::size_t Fleet::snapshot_size() const noexcept {
    return header_size + layout_.parts().size() * part_size + size() * record_size() +
           key_bytes(keys_) + checksum_size;
}

void Fleet::snapshot(std::span<std::uint8_t> out) const noexcept {
    Writer writer(out.data());
    writer.put(magic.data(), magic.size());
    writer.put(version);
    writer.put(state_version);
    writer.put(static_cast<std::uint8_t>(size() == 0 ? KeyKind::none : keys_.kind()));
    writer.put(
        static_cast<std::uint8_t>((layout_.clocked() ? 1U : 0U) | (layout_.warming() ? 2U : 0U)));
    writer.put(std::uint16_t{0});
    writer.put(static_cast<std::uint32_t>(layout_.parts().size()));
    writer.put(std::uint32_t{0});
    for (const std::uint64_t number :
         {std::uint64_t{record_size()}, std::uint64_t{size()}, std::uint64_t{settings_.capacity},
          std::bit_cast<std::uint64_t>(settings_.period), std::uint64_t{layout_.times()},
          std::uint64_t{layout_.ring_offset()}, std::uint64_t{layout_.exact_offset()}})
        writer.put(number);
    for (const Layout::Part& part : layout_.parts()) {
        const Kernel& kernel = *layout_.kernel(part.instruction);
        writer.put(Stored::Part{part.hash, kernel.head_offset(), kernel.tail_offset(),
                                static_cast<std::uint32_t>(kernel.sizes().head),
                                static_cast<std::uint32_t>(kernel.sizes().tail)});
    }
    writer.put(arena_, size() * record_size());
    put_keys(keys_, writer);
    writer.put(crc32(out.first(out.size() - checksum_size)));
}

namespace {

// The parts of a stored record that continue in the record of a layout.
class Move {
  public:
    Move(const Program& program, const Layout& layout, const Stored& stored)
        : program_(program), layout_(layout), stored_(stored) {
        for (const Layout::Part& part : layout.parts())
            found_.push_back(find(stored, layout, part));
    }

    // Whether something has to restart, or has restarted before.
    [[nodiscard]] static bool warms(const Layout& layout, const Stored& stored) {
        return stored.warming || layout.times() > std::max<std::uint64_t>(stored.times, 1) ||
               std::ranges::any_of(layout.parts(), [&](const Layout::Part& part) {
                   return find(stored, layout, part) == nullptr;
               });
    }

    void operator()(const std::byte* old, std::byte* record) {
        const auto header = read_at<Header>(old, 0);
        Layout::header(record) = header;
        const std::int64_t samples = header.samples;
        if (samples < 0 || samples >= endless / 2 || !std::isfinite(header.last)) {
            refuse("a record has an impossible time");
        }
        // The first sample with a known time, of those that may still be requested.
        std::int64_t timed = stored_.warming ? exact_at(old, 0) : 0;
        if (layout_.clocked()) timed = std::max(timed, move_clock(old, header, record));
        exact_.assign(program_.instructions.size(), 0);
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
            program_.each_operand(program_.instructions[i], [&](std::uint32_t operand) {
                exact_[i] = std::max(exact_[i], exact_[operand]);
            });
            if (next == layout_.parts().size() || layout_.parts()[next].instruction != i) continue;
            move_part(next++, old, samples, record);
        }
        if (!layout_.warming()) return;
        std::int64_t* exact = layout_.exact(record);
        *exact++ = timed;
        for (const Layout::Part& part : layout_.parts())
            *exact++ = exact_[part.instruction];
        for (const std::uint32_t output : program_.outputs) {
            const std::int64_t late = timed == 0 ? 0 : timed + program_.instructions[output].lag;
            *exact++ = std::max(exact_[output], late);
        }
    }

  private:
    const Program& program_;
    const Layout& layout_;
    const Stored& stored_;
    std::vector<const Stored::Part*> found_; // by part
    std::vector<std::int64_t> exact_;        // by instruction

    [[nodiscard]] static const Stored::Part* find(const Stored& stored, const Layout& layout,
                                                  const Layout::Part& part) {
        const Sizes sizes = layout.kernel(part.instruction)->sizes();
        const auto found = std::ranges::find_if(stored.parts, [&](const Stored::Part& other) {
            return other.hash == part.hash && other.head_size == sizes.head &&
                   other.tail_size == sizes.tail;
        });
        return found == stored.parts.end() ? nullptr : &*found;
    }

    void move_part(std::size_t index, const std::byte* old, std::int64_t samples,
                   std::byte* record) {
        const std::uint32_t instruction = layout_.parts()[index].instruction;
        const Kernel& kernel = *layout_.kernel(instruction);
        std::int64_t& exact = exact_[instruction];
        const Stored::Part* part = found_[index];
        if (part == nullptr) {
            const std::int64_t pushes = std::max<std::int64_t>(samples - kernel.lag(), 0);
            kernel.start(record, pushes);
            if (pushes != 0) exact = std::max(exact, samples);
            if (exact != 0) exact += std::min(kernel.look_back(), endless - exact);
            return;
        }
        std::memcpy(record + kernel.head_offset(), old + part->head, part->head_size);
        std::memcpy(record + kernel.tail_offset(), old + part->tail, part->tail_size);
        const auto* cells = reinterpret_cast<const double*>(record + kernel.tail_offset());
        const std::size_t count = kernel.sizes().tail / sizeof(double);
        const bool defined =
            discrete::first_undefined<Real>(cells, {0, count}) == discrete::Kernel::defined;
        if (!defined || !kernel.accept(record)) refuse("a record has an impossible state");
        if (stored_.warming) {
            exact = exact_at(old, static_cast<std::uint64_t>(part - stored_.parts.data()) + 1);
        }
    }

    [[nodiscard]] std::int64_t exact_at(const std::byte* old, std::uint64_t place) const {
        const auto exact = read_at<std::int64_t>(old, stored_.exact + 8 * place);
        if (exact < 0 || exact > endless) refuse("a record has an impossible state");
        return exact;
    }

    // Returns the first sample whose time is there; 0 if all that may still be asked for are.
    [[nodiscard]] std::int64_t move_clock(const std::byte* old, const Header& header,
                                          std::byte* record) {
        ClockState& clock = Layout::clock(record);
        double* ring = layout_.ring(record);
        const std::size_t size = layout_.times();
        if (header.samples == 0) return 0;
        if (!stored_.clocked) {
            clock = {header.last, 0, 1 % size};
            ring[0] = header.last;
            return header.samples - 1;
        }
        clock = read_at<ClockState>(old, sizeof(Header));
        const std::uint64_t next = clock.next;
        if (clock.regular < 0 || clock.regular > header.samples || next >= stored_.times ||
            !std::isfinite(clock.origin)) {
            refuse("a record has an impossible time");
        }
        const auto irregular = static_cast<std::uint64_t>(header.samples - clock.regular);
        const std::uint64_t kept = std::min({irregular, stored_.times, std::uint64_t{size}});
        for (std::uint64_t i = 0; i < kept; ++i) { // the oldest first
            const std::uint64_t cell = (next + stored_.times - kept + i) % stored_.times;
            ring[i] = read_at<double>(old, stored_.ring + 8 * cell);
            if (!std::isfinite(ring[i])) refuse("a record has an impossible time");
        }
        clock.next = kept % size;
        const bool enough = irregular == kept || kept == size;
        return enough ? 0 : header.samples - static_cast<std::int64_t>(kept);
    }
};

} // namespace

Fleet Fleet::restore(Program program, std::vector<std::string> names, Settings settings,
                     std::span<const std::uint8_t> bytes) {
    if (bytes.size() < header_size + checksum_size) {
        refuse("it has " + std::to_string(bytes.size()) + " bytes, too few");
    }
    const auto body = bytes.first(bytes.size() - checksum_size);
    Bytes rest(body);
    const Stored stored = read_header(rest);
    if (Bytes(bytes.last(checksum_size)).take<std::uint32_t>() != crc32(body)) {
        refuse("its checksum does not match, so it was damaged on the way");
    }
    if (stored.period != settings.period) {
        std::ostringstream message;
        message.precision(15);
        message << "This state is for samples " << stored.period
                << " s apart, and the specification is for samples " << settings.period
                << " s apart.";
        throw std::invalid_argument(message.str());
    }
    if (settings.capacity == 0) settings.capacity = static_cast<std::size_t>(stored.capacity);
    if (settings.capacity < stored.count) {
        throw std::invalid_argument("This state has " + std::to_string(stored.count) +
                                    " keys, more than the capacity of " +
                                    std::to_string(settings.capacity) + ".");
    }
    const bool warming = Move::warms(Layout(program, names, false), stored);
    Fleet fleet(std::move(program), std::move(names), settings, warming);
    const auto records = rest.take(stored.count * stored.record_size);
    take_keys(fleet.keys_, stored.kind, stored.count, rest);
    if (rest.left() != 0) refuse("it is too long");
    Move move(fleet.program_, fleet.layout_, stored);
    for (std::size_t i = 0; i < stored.count; ++i) {
        const auto* old = reinterpret_cast<const std::byte*>(records.data()) +
                          i * static_cast<std::size_t>(stored.record_size);
        move(old, fleet.record(i));
    }
    return fleet;
}

} // namespace rtamt::fleet
