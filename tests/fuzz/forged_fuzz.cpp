// What libFuzzer calls: a state of a monitor or a fleet that was changed, and whose checksum is
// right all the same, is refused in one sentence or does no harm.
//
// The bytes are not a state, which depends on its program and its version, but choose one of the
// programs in corpus/compiled and what is changed: the same changes of any version.
#include "changes.hpp"
#include "compiled.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace {

using compiled::Bytes;

const std::vector<Bytes>& programs() {
    static const std::vector<Bytes> all = [] {
        std::vector<std::filesystem::path> paths;
        for (const auto& entry : std::filesystem::directory_iterator(RTAMT_COMPILED))
            paths.push_back(entry.path());
        std::ranges::sort(paths);
        std::vector<Bytes> found;
        for (const auto& path : paths) {
            std::ifstream file(path, std::ios::binary);
            const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
            found.emplace_back(bytes.begin(), bytes.end());
            compiled::seal_program(found.back());
        }
        return found;
    }();
    return all;
}

template <class Subject>
void forge(const Bytes& program, changes::Choices& choices) {
    Subject subject(program);
    if (!subject) return;
    const unsigned seed = choices.take<std::uint8_t>();
    subject.run(0, seed % 13, seed);
    Bytes state = subject.save();
    if (state.empty()) return; // this kind of program has none
    compiled::expect(subject.restore(state) && subject.save() == state);
    changes::change(state, {}, choices);
    compiled::seal(state);
    if (!subject.restore(state)) return;
    subject.run(seed % 13, 6, seed);
    const Bytes later = subject.save();
    if (!later.empty()) (void)subject.restore(later);
    if constexpr (requires { subject.end(); }) subject.end();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    changes::Choices choices(data, size);
    const Bytes& program = programs()[choices.take<std::uint8_t>() % programs().size()];
    changes::Choices same = choices;
    forge<compiled::Single>(program, choices);
    forge<compiled::Fleet>(program, same);
    return 0;
}
