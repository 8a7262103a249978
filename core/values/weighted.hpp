// Keys with weights in order: which is the first up to whose end there is a given weight.
//
// A treap (R. Seidel, C. Aragon, "Randomized search trees", 1996) with the weight of each subtree,
// its nodes in one array. Equal keys are ordered by a number, so that nodes are distinct.
//
// Cost: O(log n) an operation. Memory: 64 bytes a node, reused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace rtamt {

class Weighted {
  public:
    struct Name {
        std::int64_t key;
        std::uint64_t number;
        [[nodiscard]] friend constexpr auto operator<=>(const Name&, const Name&) = default;
    };
    // A node, and the weight of all before it and up to its end.
    struct Place {
        Name name;
        std::int64_t before;
        std::int64_t upto;
    };

    void clear() noexcept {
        nodes_.clear();
        free_ = root_ = none;
    }

    [[nodiscard]] std::int64_t total() const noexcept { return weight(root_); }

    void insert(const Name& name, std::int64_t weight) {
        if (free_ == none) {
            nodes_.push_back({});
            free_ = static_cast<Index>(nodes_.size() - 1);
            nodes_.back().left = none;
        }
        const Index fresh = free_;
        free_ = nodes_[fresh].left;
        seed_ ^= seed_ << 13U;
        seed_ ^= seed_ >> 7U;
        seed_ ^= seed_ << 17U;
        nodes_[fresh] = {name, weight, weight, seed_, none, none};
        Index* link = &root_;
        while (*link != none && nodes_[*link].priority >= seed_) {
            Node& node = nodes_[*link];
            node.total += weight;
            link = name < node.name ? &node.left : &node.right;
        }
        split(*link, name, nodes_[fresh].left, nodes_[fresh].right);
        *link = fresh;
        update(fresh);
    }

    void add(const Name& name, std::int64_t weight) noexcept {
        Index at = root_;
        while (at != none) {
            Node& node = nodes_[at];
            node.total += weight;
            if (name == node.name) {
                node.weight += weight;
                return;
            }
            at = name < node.name ? node.left : node.right;
        }
    }

    // Removes a node of weight 0.
    void erase(const Name& name) noexcept {
        Index* link = &root_;
        while (nodes_[*link].name != name)
            link = name < nodes_[*link].name ? &nodes_[*link].left : &nodes_[*link].right;
        const Index old = *link;
        *link = merged(nodes_[old].left, nodes_[old].right);
        nodes_[old].left = free_;
        free_ = old;
    }

    // The first node up to whose end there is this weight, which must be positive.
    [[nodiscard]] std::optional<Place> find(std::int64_t wanted) const noexcept {
        if (wanted > total()) return std::nullopt;
        std::int64_t before = 0;
        for (Index at = root_;;) {
            const Node& node = nodes_[at];
            const std::int64_t begin = before + weight(node.left);
            const std::int64_t end = begin + node.weight;
            if (wanted <= begin) {
                at = node.left;
            } else if (wanted <= end) {
                return Place{node.name, begin, end};
            } else {
                before = end;
                at = node.right;
            }
        }
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return nodes_.capacity() * sizeof(Node); }

  private:
    using Index = std::uint32_t;
    static constexpr Index none = std::numeric_limits<Index>::max();

    struct Node {
        Name name{};
        std::int64_t weight = 0;
        std::int64_t total = 0; // of the subtree
        std::uint64_t priority = 0;
        Index left = none; // of a free node, the next one
        Index right = none;
    };

    std::vector<Node> nodes_;
    Index free_ = none;
    Index root_ = none;
    std::uint64_t seed_ = 0x9E3779B97F4A7C15U;

    [[nodiscard]] std::int64_t weight(Index at) const noexcept {
        return at == none ? 0 : nodes_[at].total;
    }

    void update(Index at) noexcept {
        Node& node = nodes_[at];
        node.total = weight(node.left) + node.weight + weight(node.right);
    }

    // Nodes before a name and after it. The depth of a treap is logarithmic, so recursion is safe.
    void split(Index at, const Name& name, Index& left, Index& right) noexcept {
        if (at == none) {
            left = right = none;
            return;
        }
        Node& node = nodes_[at];
        if (name < node.name) {
            split(node.left, name, left, node.left);
            right = at;
        } else {
            split(node.right, name, node.right, right);
            left = at;
        }
        update(at);
    }

    [[nodiscard]] Index merged(Index left, Index right) noexcept {
        if (left == none) return right;
        if (right == none) return left;
        if (nodes_[left].priority > nodes_[right].priority) {
            nodes_[left].right = merged(nodes_[left].right, right);
            update(left);
            return left;
        }
        nodes_[right].left = merged(left, nodes_[right].left);
        update(right);
        return right;
    }
};

} // namespace rtamt
