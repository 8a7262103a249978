// The keys of a fleet and their places: whole numbers, texts or bytes.
//
// Numbers that are small for how many keys there are, as those of an enumeration, are found by
// themselves in an array; all others in an open hash table. In random order that saves the access
// to a table several times as large.
//
// Places are 0, 1, 2, ... without a gap: the last key takes the place of one that is erased. The
// hash has a random seed, so that colliding keys cannot be chosen.
//
// Cost: a look-up is one access to the array or the table; of a text also its comparison. Memory:
// 24 to 136 bytes a key, and the texts.
#pragma once

#include "kernel.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtamt::fleet {

// What keys are, part of the state format; texts are UTF-8.
enum class KeyKind : std::uint8_t { none, integer, text, bytes };

// The keys of a batch: one of the two.
struct KeySpan {
    KeyKind kind = KeyKind::none;
    std::span<const std::int64_t> integers;
    std::span<const std::string_view> texts;

    [[nodiscard]] std::size_t size() const noexcept {
        return kind == KeyKind::integer ? integers.size() : texts.size();
    }
};

class Keys {
  public:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    // The entry of a key; `mark` is the caller's, initially 0.
    struct Entry {
        std::uint64_t key = 0; // the number, or the hash of the text
        std::uint32_t place = none;
        std::uint32_t mark = 0;
    };

    Keys() : table_(16), seed_(random_seed()) {}

    [[nodiscard]] std::size_t size() const noexcept {
        return textual() ? texts_.size() : integers_.size();
    }
    [[nodiscard]] KeyKind kind() const noexcept { return kind_; }
    // Whether keys are texts or bytes, which have the same storage.
    [[nodiscard]] bool textual() const noexcept {
        return kind_ == KeyKind::text || kind_ == KeyKind::bytes;
    }
    // Only while there is no key.
    void set_kind(KeyKind kind) noexcept {
        if (kind != kind_) direct_.clear();
        kind_ = kind;
    }

    [[nodiscard]] std::span<const std::uint64_t> integers() const noexcept { return integers_; }
    [[nodiscard]] std::span<const std::string> texts() const noexcept { return texts_; }

    [[nodiscard]] std::uint64_t code(std::int64_t key) const noexcept {
        return static_cast<std::uint64_t>(key);
    }
    [[nodiscard]] std::uint64_t code(std::string_view key) const noexcept {
        std::uint64_t hash = seed_ ^ key.size();
        while (!key.empty()) {
            std::uint64_t word = 0;
            const std::size_t part = key.size() < 8 ? key.size() : 8;
            for (std::size_t i = 0; i < part; ++i)
                word |= std::uint64_t{static_cast<unsigned char>(key[i])} << (8U * i);
            hash = mixed(hash ^ word);
            key.remove_prefix(part);
        }
        return hash;
    }

    void request(std::uint64_t code) const noexcept {
        prefetch(code < direct_.size() ? &direct_[code] : &table_[home(code)]);
    }

    // The entry of a key; null if there is none. Valid until the next key is added.
    template <class Key>
    [[nodiscard]] Entry* find(Key key, std::uint64_t code) noexcept {
        if (code < direct_.size()) {
            Entry& entry = direct_[code];
            return entry.place == none ? nullptr : &entry;
        }
        for (std::size_t at = home(code);; at = (at + 1) & mask()) {
            Entry& entry = table_[at];
            if (entry.place == none) return nullptr;
            if (entry.key == code && same(entry, key)) return &entry;
        }
    }

    // Adds a key that is not there, at the last place.
    template <class Key>
    Entry* add(Key key, std::uint64_t code) {
        const auto place = static_cast<std::uint32_t>(size());
        if (2 * (hashed_ + 1) > table_.size()) grow();
        if constexpr (std::is_integral_v<Key>) {
            if (code >= direct_.size() && code < sparsest * (size() + 1)) widen();
            integers_.push_back(code);
        } else {
            texts_.emplace_back(key);
        }
        return insert({code, place, 0});
    }

    // Erases the key at a place, which the last key takes.
    void erase(std::uint32_t place) noexcept {
        remove(entry_of(place));
        const auto last = static_cast<std::uint32_t>(size() - 1);
        if (place != last) entry_of(last).place = place;
        if (textual()) {
            texts_[place] = std::move(texts_[last]);
            texts_.pop_back();
        } else {
            integers_[place] = integers_[last];
            integers_.pop_back();
        }
    }

    void clear_marks() noexcept {
        for (auto* entries : {&table_, &direct_}) {
            for (Entry& entry : *entries)
                entry.mark = 0;
        }
    }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return (table_.size() + direct_.size()) * sizeof(Entry) +
               integers_.capacity() * sizeof(std::uint64_t) +
               texts_.capacity() * sizeof(std::string);
    }

  private:
    // Numbers below this multiple of the number of keys are in the array.
    static constexpr std::size_t sparsest = 4;

    std::vector<Entry> table_;  // a power of two, at least twice the number of its keys
    std::vector<Entry> direct_; // by number
    std::size_t hashed_ = 0;    // keys in the table
    std::uint64_t seed_;
    KeyKind kind_ = KeyKind::none;
    std::vector<std::uint64_t> integers_; // by place
    std::vector<std::string> texts_;      // likewise

    [[nodiscard]] static std::uint64_t random_seed() {
        std::random_device device;
        return (std::uint64_t{device()} << 32U) | device();
    }

    [[nodiscard]] static std::uint64_t mixed(std::uint64_t x) noexcept { // of SplitMix64
        x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
        x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
        return x ^ (x >> 31U);
    }

    [[nodiscard]] std::size_t mask() const noexcept { return table_.size() - 1; }
    [[nodiscard]] std::size_t home(std::uint64_t code) const noexcept {
        return static_cast<std::size_t>(mixed(code + seed_)) & mask();
    }

    [[nodiscard]] bool same(const Entry& /*entry*/, std::int64_t /*key*/) const noexcept {
        return true;
    }
    [[nodiscard]] bool same(const Entry& entry, std::string_view key) const noexcept {
        return texts_[entry.place] == key;
    }

    // The entry of the key at a place.
    [[nodiscard]] Entry& entry_of(std::uint32_t place) noexcept {
        const std::uint64_t code =
            textual() ? this->code(std::string_view(texts_[place])) : integers_[place];
        if (code < direct_.size()) return direct_[code];
        std::size_t at = home(code);
        while (table_[at].place != place)
            at = (at + 1) & mask();
        return table_[at];
    }

    Entry* insert(const Entry& entry) noexcept {
        if (entry.key < direct_.size()) {
            direct_[entry.key] = entry;
            return &direct_[entry.key];
        }
        std::size_t at = home(entry.key);
        while (table_[at].place != none)
            at = (at + 1) & mask();
        table_[at] = entry;
        ++hashed_;
        return &table_[at];
    }

    void remove(Entry& entry) noexcept {
        if (entry.key < direct_.size()) {
            entry = {};
        } else {
            close(static_cast<std::size_t>(&entry - table_.data()));
            --hashed_;
        }
    }

    // Closes the gap, so that no look-up ends too early.
    void close(std::size_t gap) noexcept {
        for (std::size_t at = (gap + 1) & mask(); table_[at].place != none;
             at = (at + 1) & mask()) {
            const std::size_t from_home = (at - home(table_[at].key)) & mask();
            if (from_home >= ((at - gap) & mask())) {
                table_[gap] = table_[at];
                gap = at;
            }
        }
        table_[gap] = {};
    }

    void grow() {
        std::vector<Entry> old(2 * table_.size());
        old.swap(table_);
        insert_again(old);
    }

    // Makes the array as large as there are numbers for it, and takes these out of the table.
    void widen() {
        direct_.resize(2 * sparsest * (size() + 1)); // twice, so that it seldom grows
        std::vector<Entry> old(table_.size());
        old.swap(table_);
        insert_again(old);
    }

    void insert_again(std::span<const Entry> entries) noexcept {
        hashed_ = 0;
        for (const Entry& entry : entries) {
            if (entry.place != none) insert(entry);
        }
    }
};

} // namespace rtamt::fleet
