#include "kleene_runs.hpp"

#include <algorithm>

namespace rtamt::early {

void KleeneRuns::fill(Tick l, Tick r, Kleene value, std::vector<Decided>& decided) {
    if (l > r || l >= forever || splice(l, r, value, decided)) return;
    for (;;) { // run by run
        const Place place = find(l);
        const Run here = run(place);
        const Tick end = std::min(here.end, r);
        if (here.value == Kleene::open) {
            decided.push_back({l, end, value});
            set(place, l, end, value);
        }
        if (end >= r || end >= forever) return;
        l = end + 1;
    }
}

// The same where all runs that it concerns lie in one chunk that has room: nearly always. If not,
// returns false, with nothing done.
bool KleeneRuns::splice(Tick l, Tick r, Kleene value, std::vector<Decided>& decided) {
    const Place place = find(l);
    Chunk& chunk = *directory_[place.chunk].chunk;
    const int first = place.index;
    int last = first;
    while (last + 1 < chunk.end && chunk.start[last + 1] <= r)
        ++last;
    const bool ends_chunk = last + 1 == chunk.end;
    if (ends_chunk && place.chunk + 1 < directory_.size()) return false;
    const Tick end = ends_chunk ? forever : chunk.start[last + 1] - 1;
    const bool splits = chunk.start[first] < l;
    if (!splits && first == chunk.begin && place.chunk > head_) return false; // what is before it?
    if (chunk.end + 2 > capacity) return false;

    const std::size_t before = decided.size();
    for (int i = first; i <= last; ++i) {
        if (chunk.value[i] != Kleene::open) continue;
        const Tick begins = i == first && splits ? l : chunk.start[i];
        const Tick ends = i == last ? std::min(end, r) : chunk.start[i + 1] - 1;
        decided.push_back({begins, ends, value});
    }
    if (decided.size() == before) return true;

    const Kleene rest = chunk.value[last];
    int joined = first; // the run that all become
    if (splits && chunk.value[first] != value) {
        ++joined;
    } else if (!splits && first > chunk.begin && chunk.value[first - 1] == value) {
        --joined;
    }
    int next = last + 1; // the first run that stays, and where it goes
    if (end <= r && next < chunk.end && chunk.value[next] == value) ++next;
    const bool remains = end > r && rest != value;
    const int to = joined + (remains ? 2 : 1);
    if (to < next) {
        std::copy(chunk.start + next, chunk.start + chunk.end, chunk.start + to);
        std::copy(chunk.value + next, chunk.value + chunk.end, chunk.value + to);
    } else if (to > next && next < chunk.end) {
        const int shift = to - next;
        std::copy_backward(chunk.start + next, chunk.start + chunk.end,
                           chunk.start + chunk.end + shift);
        std::copy_backward(chunk.value + next, chunk.value + chunk.end,
                           chunk.value + chunk.end + shift);
    }
    chunk.end += to - next;
    if (joined > first) chunk.start[joined] = l;
    chunk.value[joined] = value;
    if (remains) {
        chunk.start[joined + 1] = r + 1;
        chunk.value[joined + 1] = rest;
    }
    return true;
}

} // namespace rtamt::early
