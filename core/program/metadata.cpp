#include "metadata.hpp"

#include "reader.hpp"

#include <bit>
#include <span>
#include <stdexcept>
#include <utility>

namespace rtamt {

namespace {

[[noreturn]] void refuse(const std::string& reason) {
    throw std::invalid_argument("This is not a program that can be carried: " + reason + ".");
}

// Reads a note, whose lengths may be anything.
class NoteReader {
  public:
    explicit NoteReader(const Program& program)
        : program_(program),
          reader_({reinterpret_cast<const std::uint8_t*>(program.note.data()), // bytes as they are
                   program.note.size()}) {}

    template <class Unsigned>
    [[nodiscard]] Unsigned number() {
        need(sizeof(Unsigned));
        return reader_.take<Unsigned>();
    }

    // The number of records that follow, each of at least 4 bytes.
    [[nodiscard]] std::uint32_t count() {
        const auto count = number<std::uint32_t>();
        need(std::size_t{4} * count);
        return count;
    }

    [[nodiscard]] std::string bytes() {
        const auto length = number<std::uint32_t>();
        need(length);
        return reader_.text(length);
    }

    [[nodiscard]] std::string text() {
        std::string text = bytes();
        if (text.find('\0') != std::string::npos) refuse("a name in it has a zero byte");
        return text;
    }

    [[nodiscard]] std::vector<std::string> texts(std::size_t count) {
        need(4 * count);
        std::vector<std::string> texts;
        texts.reserve(count);
        for (std::size_t i = 0; i < count; ++i)
            texts.push_back(text());
        return texts;
    }

    // The index of one of `count` things.
    [[nodiscard]] std::uint32_t index(std::size_t count, const char* what) {
        const auto index = number<std::uint32_t>();
        if (index >= count) {
            refuse("its metadata names " + std::string(what) + " " + std::to_string(index) +
                   " of " + std::to_string(count));
        }
        return index;
    }

    [[nodiscard]] std::uint32_t instruction() {
        return index(program_.instructions.size(), "instruction");
    }

    [[nodiscard]] Parameter parameter() {
        Parameter parameter;
        parameter.name = text();
        const auto places = count();
        for (std::uint32_t i = 0; i < places; ++i) {
            const auto place = instruction();
            if (program_.instructions[place].opcode != Opcode::constant) {
                refuse("its parameter '" + parameter.name + "' is instruction " +
                       std::to_string(place) + ", which is no constant");
            }
            parameter.instructions.push_back(place);
        }
        if (places == 0) refuse("its parameter '" + parameter.name + "' stands nowhere");
        return parameter;
    }

    // Indices of things of which there are `count`.
    [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t count, const char* what) {
        std::vector<std::uint32_t> indices(this->count());
        for (std::uint32_t& each : indices)
            each = index(count, what);
        return indices;
    }

    [[nodiscard]] Enumeration enumeration() {
        Enumeration enumeration;
        enumeration.name = text();
        const auto members = count();
        for (std::uint32_t i = 0; i < members; ++i) {
            std::string name = text();
            const auto code = std::bit_cast<std::int64_t>(number<std::uint64_t>());
            enumeration.members.push_back({std::move(name), code});
        }
        if (members == 0) refuse("its enumeration '" + enumeration.name + "' has no members");
        return enumeration;
    }

    // The types of parameters that are enumerated.
    void enumerations(std::vector<Parameter>& parameters) {
        const auto enumerated = count();
        for (std::uint32_t i = 0; i < enumerated; ++i) {
            Parameter& parameter = parameters[index(parameters.size(), "parameter")];
            if (parameter.boolean || !parameter.enumeration.members.empty())
                refuse("its parameter '" + parameter.name + "' has two types");
            parameter.enumeration = enumeration();
        }
    }

    [[nodiscard]] bool left() const noexcept { return reader_.left() != 0; }

    void end() const {
        if (reader_.left() != 0) refuse("its metadata is longer than it should be");
    }

  private:
    const Program& program_;
    Reader reader_;

    void need(std::size_t size) const {
        if (size > reader_.left()) refuse("its metadata is shorter than it should be");
    }
};

} // namespace

Metadata Metadata::parse(const Program& program) {
    if (program.note.empty()) refuse("it has no metadata, so the names of its inputs are unknown");
    NoteReader note(program);
    Metadata metadata;
    metadata.numerator = std::bit_cast<std::int64_t>(note.number<std::uint64_t>());
    metadata.denominator = std::bit_cast<std::int64_t>(note.number<std::uint64_t>());
    if (metadata.numerator <= 0 || metadata.denominator <= 0) {
        refuse("the length of its step is " + std::to_string(metadata.numerator) + "/" +
               std::to_string(metadata.denominator) + " s");
    }
    metadata.name = note.text();
    metadata.formula = note.text();
    metadata.inputs = note.texts(program.inputs);
    metadata.outputs = note.texts(program.outputs.size());
    const auto parameters = note.count();
    for (std::uint32_t i = 0; i < parameters; ++i)
        metadata.parameters.push_back(note.parameter());
    const auto meanings = note.count();
    for (std::uint32_t i = 0; i < meanings; ++i) {
        const auto instruction = note.instruction();
        metadata.meanings[instruction] = note.text();
    }
    metadata.early = note.bytes();
    if (note.left()) {
        metadata.booleans = note.indices(metadata.inputs.size(), "input");
        for (const std::uint32_t index : note.indices(metadata.parameters.size(), "parameter"))
            metadata.parameters[index].boolean = true;
        if (note.left()) note.enumerations(metadata.parameters);
    }
    note.end();
    return metadata;
}

} // namespace rtamt
