#include "program/metadata.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <stdexcept>

using rtamt::Metadata;
using rtamt::Program;

static std::string refusal(const Program& program) {
    return thrown<std::invalid_argument>([&] { (void)Metadata::parse(program); });
}

static std::string refused(const std::string& reason) {
    return "This is not a program that can be carried: " + reason + ".";
}

static Metadata good() {
    return Metadata::parse(programs::carried());
}

static std::string refusal_of(const Metadata& metadata) {
    Program program = programs::carried();
    program.note = programs::note_of(metadata);
    return refusal(program);
}

TEST_CASE("what was written is read") {
    const Metadata metadata = good();
    CHECK((metadata.numerator == 1 && metadata.denominator == 10 && metadata.seconds() == 0.1));
    CHECK((metadata.name == "ratio" && metadata.formula == "always[0:0.3](a / b >= limit)"));
    CHECK(metadata.inputs == std::vector<std::string>({"a", "b"}));
    CHECK(metadata.outputs == std::vector<std::string>({"robustness", "ratio"}));
    CHECK((metadata.parameters.size() == 1 && metadata.parameters[0].name == "limit"));
    CHECK(metadata.parameters[0].instructions == std::vector<std::uint32_t>({2}));
    CHECK((metadata.meanings.at(3) == "a / b" && metadata.meanings.at(4) == "a / b - limit"));
}

TEST_CASE("no truncation is read") {
    Program program = programs::carried();
    const std::string note = program.note;
    program.note.clear();
    CHECK(refusal(program) ==
          refused("it has no metadata, so the names of its inputs are unknown"));
    for (std::size_t size = 1; size < note.size(); ++size) {
        program.note = note.substr(0, size);
        CHECK(refusal(program) == refused("its metadata is shorter than it should be"));
    }
    program.note = note + "x";
    CHECK(refusal(program) == refused("its metadata is shorter than it should be"));
    program.note = note + std::string(8, '\0') + "x";
    CHECK(refusal(program) == refused("its metadata is shorter than it should be"));
    program.note = note + std::string(12, '\0') + "x";
    CHECK(refusal(program) == refused("its metadata is longer than it should be"));
}

TEST_CASE("Boolean inputs and parameters are read") {
    CHECK((good().booleans.empty() && !good().parameters[0].boolean));
    Program program = programs::carried();
    Metadata metadata = good();
    metadata.booleans = {1};
    metadata.parameters[0].boolean = true;
    program.note = programs::note_of(metadata);
    const Metadata read = Metadata::parse(program);
    CHECK(read.booleans == std::vector<std::uint32_t>({1}));
    CHECK(read.parameters[0].boolean);
    metadata.booleans = {2};
    CHECK(refusal_of(metadata) == refused("its metadata names input 2 of 2"));
}

// A program whose parameter is enumerated.
static Metadata enumerated() {
    Metadata metadata = good();
    metadata.parameters[0].enumeration = {"Mode", {{"MANUAL", 0}, {"AUTO", -4}}};
    return metadata;
}

TEST_CASE("enumerated parameters are read") {
    CHECK(good().parameters[0].enumeration.members.empty());
    Program program = programs::carried();
    program.note = programs::note_of(enumerated());
    const rtamt::Enumeration read = Metadata::parse(program).parameters[0].enumeration;
    CHECK((read.name == "Mode" && read.members.size() == 2));
    CHECK((read.members[0].name == "MANUAL" && read.members[0].code == 0));
    CHECK((read.members[1].name == "AUTO" && read.members[1].code == -4));
    CHECK(Metadata::parse(program).booleans.empty());
}

TEST_CASE("enumerated parameters that make no sense are refused") {
    const std::size_t plain = programs::note_of(good()).size();
    Program program = programs::carried();
    const std::string note = programs::note_of(enumerated());
    program.note = note + "x";
    CHECK(refusal(program) == refused("its metadata is longer than it should be"));
    for (std::size_t size = plain + 1; size < note.size(); ++size) {
        program.note = note.substr(0, size);
        const bool whole = size == plain + 8; // as of a program without enumerations
        CHECK(refusal(program) ==
              (whole ? "no exception" : refused("its metadata is shorter than it should be")));
    }
    Metadata metadata = enumerated();
    metadata.parameters[0].boolean = true;
    CHECK(refusal_of(metadata) == refused("its parameter 'limit' has two types"));
    metadata = enumerated();
    metadata.parameters[0].enumeration.members.clear();
    CHECK(refusal_of(metadata) == refused("its enumeration 'Mode' has no members"));
    metadata = enumerated();
    metadata.parameters[0].enumeration.members[1].name = std::string("a\0b", 3);
    CHECK(refusal_of(metadata) == refused("a name in it has a zero byte"));
    const std::size_t index = plain + 12; // after three numbers of items
    program.note = note;
    program.note[index] = 1;
    CHECK(refusal(program) == refused("its metadata names parameter 1 of 1"));
    const std::string type = note.substr(index);
    program.note = note + type;
    program.note[plain + 8] = 2;
    CHECK(refusal(program) == refused("its parameter 'limit' has two types"));
}

TEST_CASE("lengths that promise the world are refused") {
    const std::string note = programs::note_of(enumerated());
    for (std::size_t place = 16; place + 4 <= note.size(); ++place) {
        Program program = programs::carried();
        program.note = note;
        program.note.replace(place, 4, "\xFF\xFF\xFF\xFF");
        const std::string answer = refusal(program);
        CHECK_MESSAGE((answer == "no exception" || answer.starts_with(refused("").substr(0, 43))),
                      answer);
    }
}

TEST_CASE("what makes no sense is refused") {
    Metadata metadata = good();
    metadata.denominator = 0;
    CHECK(refusal_of(metadata) == refused("the length of its step is 1/0 s"));
    metadata = good();
    metadata.numerator = -1;
    CHECK(refusal_of(metadata) == refused("the length of its step is -1/10 s"));
    metadata = good();
    metadata.parameters[0].instructions = {3};
    CHECK(refusal_of(metadata) ==
          refused("its parameter 'limit' is instruction 3, which is no constant"));
    metadata.parameters[0].instructions = {6};
    CHECK(refusal_of(metadata) == refused("its metadata names instruction 6 of 6"));
    metadata.parameters[0].instructions = {};
    CHECK(refusal_of(metadata) == refused("its parameter 'limit' stands nowhere"));
    metadata = good();
    metadata.inputs[0] = std::string("a\0b", 3);
    CHECK(refusal_of(metadata) == refused("a name in it has a zero byte"));
}
