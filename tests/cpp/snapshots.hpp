// An executor that continues from a snapshot of another one.
#pragma once

#include "program/program.hpp"
#include "program/snapshot.hpp"

#include <memory>

namespace snapshots {

template <class Executor>
std::unique_ptr<Executor> restored(Executor& executor, const rtamt::Program& program) {
    rtamt::Snapshot written;
    executor.transfer(written);
    rtamt::Snapshot read(written.bytes());
    auto other = std::make_unique<Executor>(program);
    other->transfer(read);
    read.end();
    return other;
}

} // namespace snapshots
