#include "fmi/component.hpp"

#include "check.hpp"
#include "fmi/error_boundary.hpp"
#include "forged.hpp"
#include "programs.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>

using rtamt::Domain;
using rtamt::fmi::Component;
using rtamt::fmi::error_boundary;
using rtamt::fmi::Outcome;

namespace {
// References: the inputs a and b, then the outputs, then the parameter and the time.
enum Reference : std::uint32_t { a, b, robustness, verdict, known, since, limit, now };

// A folder with the program of always[0:0.3](a / b >= limit), and its token.
struct Folder {
    std::filesystem::path path;
    std::string token;

    explicit Folder(Domain domain) {
        path = std::filesystem::temp_directory_path() /
               ("rtamt-unit-" + std::to_string(static_cast<int>(domain)) + "-" +
                std::to_string(reinterpret_cast<std::uintptr_t>(this)));
        std::filesystem::create_directories(path);
        const auto bytes = programs::bytes_of(programs::carried(domain));
        std::ofstream file(path / "program.rtamt", std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        std::uint32_t sum = 0;
        for (std::size_t i = 0; i < 4; ++i)
            sum |= std::uint32_t{bytes[bytes.size() - 4 + i]} << (8 * i);
        std::array<char, 20> text{};
        (void)std::snprintf(text.data(), text.size(), "rtamt-%08x", sum);
        token = text.data();
    }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    Folder(Folder&&) = delete;
    Folder& operator=(Folder&&) = delete;

    [[nodiscard]] Component component() const { return {path.string(), token}; }
};

void set(Component& component, Reference reference, double value) {
    component.set(std::array{std::uint32_t{reference}}, std::array{value});
}

void set(Component& component, double first, double second) {
    component.set(std::array{std::uint32_t{a}, std::uint32_t{b}}, std::array{first, second});
}

// Starts a simulation at this time.
void start(Component& component, double time) {
    component.begin(time);
    component.initialise();
    component.settle();
}

std::string refusal(Component& component, double from, double length) {
    std::string said = "done";
    const auto before = component.save();
    (void)error_boundary(
        &component, [&] { component.advance(from, length); },
        [&](Outcome, const char* sentence) { said = sentence; });
    CHECK((component.save() == before || said == "done"));
    return said;
}
} // namespace

TEST_CASE("a uri becomes a path") {
    CHECK(rtamt::fmi::path_of("file:///tmp/a%20b/c") == "/tmp/a b/c");
    CHECK(rtamt::fmi::path_of("file:/tmp/%zz%4") == "/tmp/%zz%4");
    CHECK(rtamt::fmi::path_of("file://localhost/x%2Fy") == "/x/y");
    CHECK(rtamt::fmi::path_of("file:///C:/units") == "C:/units");
    CHECK(rtamt::fmi::path_of("/already/a/path") == "/already/a/path");
}

TEST_CASE("a step takes the samples in it") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    component.begin(2.0);
    component.initialise();
    CHECK(component.real(limit) == 1.5);
    set(component, limit, 1.0);
    component.settle();
    set(component, 6.0, 2.0);
    component.advance(2.0, 0.3);
    CHECK((!component.boolean(known) && component.integer(verdict) == 0));
    CHECK((component.real(robustness) == 0.0 && component.real(now) == 2.3));
    set(component, 8.0, 2.0);
    component.advance(2.3, 0.0); // nothing passes
    component.advance(2.3, 0.1);
    CHECK((component.boolean(known) && component.real(robustness) == 2.0));
    CHECK((component.integer(verdict) == 1 && component.real(since) == 2.0));
    component.advance(2.4, 0.5);
    CHECK((component.real(robustness) == 3.0 && component.reached() == 2.4 + 0.5));
    component.reset();
    CHECK((!component.boolean(known) && component.real(limit) == 1.5 && component.real(a) == 0.0));
}

TEST_CASE("what cannot be a step is refused and nothing has changed") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    CHECK(refusal(component, 0.0, 0.1) == "There is no step before the end of the initialisation, "
                                          "and none after the end of the simulation.");
    start(component, 0.0);
    set(component, 3.0, 1.0);
    component.advance(0.0, 0.1);
    CHECK(refusal(component, 0.1, 0.15) ==
          "The communication point 0.25 s is no sampling instant: points must be 0 s plus a "
          "multiple of the period, 0.1 s.");
    CHECK(refusal(component, 0.3, 0.1) ==
          "The step begins at 0.3 s, but the last one ended at 0.1 s.");
    CHECK(refusal(component, 0.1, -0.1) == "A step from 0.1 s of -0.1 s is none: both must be "
                                           "finite, and the length not negative.");
    set(component, b, std::numeric_limits<double>::quiet_NaN());
    CHECK(refusal(component, 0.1, 0.1) ==
          "'b' is NaN at sample 1, time 0.1 s: fill the gap or leave the sample out.");
    set(component, 0.0, 0.0);
    CHECK(refusal(component, 0.1, 0.5).starts_with("'a / b' has no value at sample 1, time 0.1 s"));
    set(component, 3.0, 1.0);
    CHECK(refusal(component, 0.1, 0.1) == "done");
    CHECK(thrown<std::invalid_argument>([&] { set(component, limit, 2.0); }) ==
          "The parameter 'limit' can only be set before the end of the initialisation.");
    CHECK(thrown<std::invalid_argument>([&] { set(component, known, 2.0); }) ==
          "The variable with the reference 4 cannot be set.");
    CHECK(thrown<std::invalid_argument>([&] { (void)component.real(99); }) ==
          "There is no real variable with the reference 99.");
    CHECK(thrown<std::invalid_argument>([&] { (void)component.integer(robustness); }) ==
          "There is no integer variable with the reference 2.");
    CHECK(thrown<std::invalid_argument>([&] { (void)component.boolean(verdict); }) ==
          "There is no Boolean variable with the reference 3.");
}

TEST_CASE("several variables are set, or none if one is refused") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    const std::array<std::uint32_t, 3> references{a, limit, verdict};
    const auto before = component.save();
    CHECK(thrown<std::invalid_argument>([&] {
              component.set(references, std::array{4.0, 2.0, 1.0});
          }) == "The variable with the reference 3 cannot be set.");
    CHECK(component.save() == before);
    CHECK(thrown<std::invalid_argument>([&] {
              component.set(std::span(references).first(2),
                            std::array{4.0, std::numeric_limits<double>::quiet_NaN()});
          }) == "The parameter 'limit' may not be NaN.");
    CHECK(component.save() == before);
    component.set(std::span(references).first(2), std::array{4.0, 2.0});
    CHECK((component.real(a) == 4.0 && component.real(limit) == 2.0));
}

TEST_CASE("calls at the wrong time of a unit's life are refused and change nothing") {
    const Folder folder(Domain::dense);
    Component component = folder.component();
    const auto said = [&](auto call) {
        const auto before = component.save();
        std::string sentence = thrown<std::invalid_argument>(call);
        CHECK(component.save() == before);
        return sentence;
    };
    const auto begin = [&] { component.begin(1.0); };
    const auto initialise = [&] { component.initialise(); };
    const auto settle = [&] { component.settle(); };
    const auto terminate = [&] { component.terminate(); };
    const std::string late_start =
        "Setting the start time is only possible before the initialisation begins.";
    const std::string late_initialisation =
        "The beginning of the initialisation is only possible once, or after a reset.";
    const std::string no_settling =
        "The end of the initialisation is only possible after its beginning.";
    const std::string no_end =
        "The end of the simulation is only possible once, after the initialisation.";
    CHECK(said([&] { component.begin(std::numeric_limits<double>::quiet_NaN()); }) ==
          "The start time is nan: it must be finite.");
    CHECK((said(settle) == no_settling && said(terminate) == no_end));
    component.initialise();
    CHECK((said(begin) == late_start && said(initialise) == late_initialisation));
    CHECK(said(terminate) == no_end);
    component.settle();
    CHECK((said(begin) == late_start && said(initialise) == late_initialisation));
    CHECK(said(settle) == no_settling);
    component.terminate();
    CHECK((said(begin) == late_start && said(initialise) == late_initialisation));
    CHECK((said(settle) == no_settling && said(terminate) == no_end));
    component.reset();
    start(component, 1.0);
}

TEST_CASE("a code that does not fit into 32 bits is refused") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    set(component, limit, -2147483648.0);
    CHECK(component.integer32(limit) == std::numeric_limits<std::int32_t>::min());
    set(component, limit, 2147483648.0);
    CHECK(component.integer(limit) == 2147483648);
    CHECK(thrown<std::invalid_argument>([&] { (void)component.integer32(limit); }) ==
          "The variable with the reference 6 is 2147483648, which does not fit into 32 bits.");
}

TEST_CASE("a long step is its samples one by one, and one of too many is refused") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    Component other = folder.component();
    start(component, 0.0);
    start(other, 0.0);
    constexpr int count = 10'000;
    set(component, 6.0, 2.0);
    component.advance(0.0, 0.1 * count);
    set(other, 6.0, 2.0);
    for (int i = 0; i < count; ++i)
        other.advance(0.1 * i, 0.1);
    CHECK((component.real(robustness) == other.real(robustness)));
    CHECK((component.real(since) == other.real(since) && component.boolean(known)));
    set(component, 0.0, 0.0);
    CHECK(refusal(component, 0.1 * count, 0.1 * count)
              .starts_with("'a / b' has no value at sample 10000, time 1000 s"));
    CHECK(refusal(component, 0.1 * count, 1e9) ==
          "The step from 1000 s to 1000001000 s takes 10000000000 samples: make steps of at most "
          "100000000 samples.");
}

TEST_CASE("inputs and parameters are numbers whatever their type") {
    const Folder folder(Domain::discrete);
    Component component = folder.component();
    set(component, a, 1.0);
    set(component, limit, 4.0);
    CHECK((component.boolean(a) && component.integer(limit) == 4 && !component.boolean(b)));
    set(component, a, 0.5);
    CHECK(thrown<std::invalid_argument>([&] { (void)component.integer(a); }) ==
          "There is no integer variable with the reference 0.");
}

TEST_CASE("in dense time communication points are samples") {
    const Folder folder(Domain::dense);
    Component component = folder.component();
    start(component, 0.0);
    set(component, 3.0, 1.0);
    component.advance(0.0, 0.25);
    CHECK(!component.boolean(known));
    set(component, 9.0, 1.0);
    component.advance(0.25, 0.35);
    component.advance(0.6, 0.1);
    CHECK((component.boolean(known) && component.real(robustness) == 7.5));
    CHECK((component.real(since) == 0.3 && component.integer(verdict) == 1));
    CHECK(refusal(component, 0.2, 0.1) ==
          "The step begins at 0.2 s, but the last one ended at 0.7 s.");
}

TEST_CASE("a state goes to another unit and a damaged one nowhere") {
    for (const Domain domain : {Domain::discrete, Domain::dense}) {
        const Folder folder(domain);
        Component component = folder.component();
        set(component, limit, 0.5);
        start(component, 0.0);
        for (int i = 0; i < 7; ++i) {
            set(component, 3.0 + i % 3, 1.0 + i % 2);
            component.advance(0.1 * i, 0.1);
        }
        const auto state = component.save();
        Component other = folder.component();
        other.restore(state);
        CHECK((other.save() == state && other.real(limit) == 0.5 && other.boolean(known)));
        set(component, 1.0, 1.0);
        set(other, 1.0, 1.0);
        component.advance(0.7, 0.1);
        other.advance(0.7, 0.1);
        CHECK(other.real(robustness) == component.real(robustness));
        CHECK((other.real(since) == component.real(since) && other.reached() == 0.7 + 0.1));
        const auto before = other.save();
        for (std::size_t place = 0; place < state.size(); ++place) {
            auto damaged = state;
            damaged[place] ^= 0x10U;
            CHECK(thrown<std::invalid_argument>([&] { other.restore(damaged); }) != "no exception");
            damaged.resize(place);
            CHECK(thrown<std::invalid_argument>([&] { other.restore(damaged); }) != "no exception");
        }
        CHECK(other.save() == before);
    }
}

TEST_CASE("a forged state with a right checksum is refused or does no harm") {
    for (const Domain domain : {Domain::discrete, Domain::dense}) {
        const Folder folder(domain);
        Component component = folder.component();
        start(component, 0.0);
        set(component, 3.0, 1.0);
        component.advance(0.0, 0.1);
        const auto state = component.save();
        // Layout, phase, six numbers, known, two inputs, checksum; then the state of the monitor.
        constexpr std::ptrdiff_t size = 74;
        const auto outside = state.begin() + size;
        const std::vector<std::uint8_t> head(state.begin(), outside);
        CHECK(programs::sealed(head) == head);
        std::size_t refused = 0;
        std::size_t taken = 0;
        Component victim = folder.component();
        forged::each(head, [&](std::vector<std::uint8_t> forgery) {
            forgery.insert(forgery.end(), outside, state.end());
            const auto before = victim.save();
            if (thrown<std::invalid_argument>([&] { victim.restore(forgery); }) != "no exception") {
                ++refused;
                CHECK(victim.save() == before);
                return;
            }
            ++taken;
            (void)refusal(victim, 0.1, 0.1);
            (void)refusal(victim, -1e300, 0.1);
            (void)victim.integer(verdict);
        });
        CHECK((refused > 50 && taken > 50));
    }
}

TEST_CASE("the wrong program is refused") {
    const Folder folder(Domain::discrete);
    const auto refused = [](const std::string& path, const std::string& token) {
        return thrown<std::invalid_argument>([&] { const Component made(path, token); });
    };
    CHECK(refused(folder.path.string(), "rtamt-00000000") ==
          "The model description is for the program 'rtamt-00000000', but the unit carries '" +
              folder.token + "'.");
    CHECK(refused("/nowhere", folder.token) ==
          "The program '/nowhere/program.rtamt' cannot be read.");
}
