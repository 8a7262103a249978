// The message of a call that failed: a copy, because the call may be rolled back or destroyed
// before it is read.
//
// Memory: its own; longer sentences are cut.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace rtamt {

class Fault {
  public:
    Fault() = default;
    explicit Fault(const char* sentence) noexcept : present_(sentence != nullptr) {
        if (!present_) return;
        const std::string_view text(sentence);
        size_ = text.copy(text_.data(), text_.size());
    }

    explicit operator bool() const noexcept { return present_; }
    [[nodiscard]] std::string_view text() const noexcept { return {data(), size_}; }
    [[nodiscard]] const char* data() const noexcept { return text_.data(); }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

  private:
    std::array<char, 256> text_{};
    std::size_t size_ = 0;
    bool present_ = false;
};

} // namespace rtamt
