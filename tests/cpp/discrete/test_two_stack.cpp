#include "discrete/two_stack.hpp"

#include "discrete/window.hpp"
#include "values/laws.hpp"

#include <string>
#include <vector>

using namespace rtamt;
using rtamt::discrete::Operands;
using rtamt::discrete::TwoStack;

namespace {

// Every window from its elements, oldest to newest; then the windows that empty after the last.
template <Monoid M>
std::vector<typename M::Value> definition(const std::vector<typename M::Value>& a,
                                          const std::vector<typename M::Value>& b,
                                          std::size_t width) {
    std::vector<typename M::Value> results;
    const Operands<M> in{a.data(), b.data()};
    for (std::size_t end = 1; end <= a.size() + width; ++end) {
        typename M::Element total = M::identity;
        for (std::size_t i = end > width ? end - width : 0; i < std::min(end, a.size()); ++i)
            total = M::append(total, in[i]);
        results.push_back(M::result(total));
    }
    return results;
}

template <Monoid M, ValueDomain D>
void check_windows(const char* name) {
    using Values = std::vector<typename D::Value>;
    oracle::Random random(1);
    for (const std::size_t width : {1U, 2U, 3U, 4U, 5U, 7U, 16U, 33U}) {
        for (int round = 0; round < 12; ++round) {
            const auto count = static_cast<std::size_t>(random.between(0, 90));
            Values a(count);
            Values b(count);
            for (std::size_t i = 0; i < count; ++i) {
                a[i] = laws::Sampler<D>::one(random);
                b[i] = laws::Sampler<D>::one(random);
            }
            std::vector<typename M::Element> ring(width);
            std::vector<typename M::Element> journal(width);
            TwoStack<M> stack(width, ring.data(), journal.data());
            Values results(count + width);
            for (std::size_t i = 0; i < count;) {
                const auto part = std::min<std::size_t>(
                    count - i, static_cast<std::size_t>(random.between(1, 40)));
                const Operands<M> in = Operands<M>{a.data(), b.data()}.from(i);
                if (random.chance(40)) { // taken back
                    stack.checkpoint(part);
                    stack.push(in, results.data() + i, part);
                    stack.rollback();
                }
                stack.push(in, results.data() + i, part);
                i += part;
            }
            stack.expire(results.data() + count, width);
            CHECK_MESSAGE(results == (definition<M>(a, b, width)),
                          (std::string(name) + ", width " + std::to_string(width)));
        }
    }
}

template <ValueDomain D>
void check_domain(const char* name) {
    check_windows<Joined<MaxOf<D>>, D>(name);
    check_windows<Joined<MinOf<D>>, D>(name);
    check_windows<UntilSteps<D>, D>(name);
}

} // namespace

TEST_CASE("windows are their definition in every domain also after a rollback") {
    check_domain<Real>("real");
    check_domain<Interval>("interval");
    check_domain<Lanes<8>>("lanes");
    check_domain<Truth>("truth");
}

// The loops that window.hpp unrolls, and those of every other monoid.
TEST_CASE("the unrolled window gives what the general one gives") {
    using Lane = Lanes<1>;
    oracle::Random random(2);
    for (const std::size_t width : {1U, 3U, 4U, 9U, 64U}) {
        const std::size_t count = 500;
        std::vector<double> a = random.signal(count);
        std::vector<Lane::Value> lanes;
        for (const double x : a)
            lanes.push_back({{x}});
        std::vector<double> ring(width);
        std::vector<Lane::Value> lane_ring(width);
        TwoStack<Joined<Max>> unrolled(width, ring.data(), nullptr);
        TwoStack<Joined<MaxOf<Lane>>> general(width, lane_ring.data(), nullptr);
        std::vector<double> results(count);
        std::vector<Lane::Value> lane_results(count);
        unrolled.push({a.data(), nullptr}, results.data(), count);
        general.push({lanes.data(), nullptr}, lane_results.data(), count);
        for (std::size_t i = 0; i < count; ++i)
            CHECK(results[i] == lane_results[i].lane[0]);
    }
}
