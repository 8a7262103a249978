// What libFuzzer calls: bytes that may be a compiled program of any kind are refused in one
// sentence, or run, saved and restored without harm.
#include "compiled.hpp"

namespace {

template <class Subject>
void use(const compiled::Bytes& program, unsigned seed) {
    Subject subject(program);
    if (!subject) return;
    subject.run(0, 8, seed);
    const compiled::Bytes state = subject.save();
    if (!state.empty() && subject.restore(state)) subject.run(8, 4, seed);
    if constexpr (requires { subject.end(); }) subject.end();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    compiled::Bytes program(data, data + size);
    compiled::seal_program(program);
    const unsigned seed = rtamt::crc32(program) % 64;
    use<compiled::Single>(program, seed);
    use<compiled::Fleet>(program, seed);
    return 0;
}
