#include "dense/ring.hpp"

#include "ways.hpp"

#include <algorithm>
#include <deque>
#include <utility>

using rtamt::dense::Ring;
using ways::Random;

namespace {

bool same(const Ring<int>& ring, const std::deque<int>& expected) {
    if (ring.size() != expected.size() || ring.empty() != expected.empty()) return false;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (ring[i] != expected[i]) return false;
    }
    return expected.empty() || (ring.front() == expected.front() && ring.back() == expected.back());
}

void change(Ring<int>& ring, std::deque<int>& model, Random& random, int& next) {
    const auto action = random.between(0, 9);
    if (action < 5 || model.empty()) {
        ring.push_back(next);
        model.push_back(next++);
    } else if (action < 7) {
        ring.pop_front();
        model.pop_front();
    } else if (action < 9) {
        ring.pop_back();
        model.pop_back();
    } else {
        const auto i = static_cast<std::size_t>(
            random.between(0, static_cast<std::int64_t>(model.size()) - 1));
        ring.edit(i) = next;
        model[i] = next++;
    }
}

} // namespace

TEST_CASE("a ring is a deque and takes back any update") {
    Random random(10);
    for (int round = 0; round < 300; ++round) {
        Ring<int> ring;
        std::deque<int> model;
        int next = 0;
        for (int update = 0; update < 20; ++update) {
            const std::deque<int> before = model;
            const auto outcome = random.between(0, 2);
            if (outcome != 0) ring.checkpoint();
            const auto changes = random.between(0, 30);
            for (std::int64_t i = 0; i < changes; ++i)
                change(ring, model, random, next);
            CHECK(same(ring, model));
            if (outcome == 2) {
                ring.rollback();
                model = before;
            }
            CHECK(same(ring, model));
        }
        ring.clear();
        CHECK(ring.empty());
    }
}

TEST_CASE("a ring that is loosened for a while is a deque") {
    Random random(11);
    for (int round = 0; round < 300; ++round) {
        Ring<int> ring;
        std::deque<int> model;
        int next = 0;
        for (int update = 0; update < 20; ++update) {
            const auto entering = random.between(0, 30);
            auto loose = ring.loosen(static_cast<std::size_t>(entering));
            for (std::int64_t i = 0; i < entering; ++i) {
                loose.push_back(next);
                model.push_back(next++);
                CHECK((loose.front() == model.front() && loose.back() == model.back()));
                if (random.between(0, 2) == 0) loose.edit_back() = model.back() = next++;
                while (!model.empty() && random.between(0, 2) == 0) {
                    loose.pop_front();
                    model.pop_front();
                }
                if (!model.empty() && random.between(0, 3) == 0) {
                    loose.pop_back();
                    model.pop_back();
                }
                CHECK((loose.size() == model.size() && loose.empty() == model.empty()));
            }
            ring.fasten(loose);
            CHECK(same(ring, model));
            if (random.between(0, 3) == 0) { // an update that is taken back, as any ring does
                ring.checkpoint();
                ring.push_back(next);
                ring.rollback();
                CHECK(same(ring, model));
            }
        }
    }
}

TEST_CASE("a ring that is emptied is reused") {
    Ring<int> ring;
    for (int i = 0; i < 100000; ++i) {
        ring.push_back(i);
        if (ring.size() > 5) ring.pop_front();
    }
    CHECK((ring.size() == 5 && ring.bytes() == 8 * sizeof(int)));
}

TEST_CASE("counting from the front stops where the condition does") {
    Ring<int> ring;
    for (int size = 0; size < 40; ++size) {
        for (int limit = 0; limit <= size + 1; ++limit) {
            const auto count = ring.count_while([&](std::size_t i) { return ring[i] < limit; });
            CHECK(std::cmp_equal(count, std::min(limit, size)));
        }
        ring.push_back(size);
    }
}
