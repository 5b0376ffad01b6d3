#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace lancet::mesh {

/// A sequence of numbers or the like that is nearly always short: up to `capacity` of them are kept in place.
template <class T, std::size_t capacity>
class InlineVector {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    using value_type = T;

    InlineVector() = default;
    explicit InlineVector(std::size_t count) : size_(count) {
        if (count > capacity) many_.resize(count);
    }
    template <class Iterator>
    InlineVector(Iterator first, Iterator last) {
        for (; first != last; ++first) push_back(*first);
    }

    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    T* data() noexcept { return size_ <= capacity ? few_.data() : many_.data(); }
    const T* data() const noexcept { return size_ <= capacity ? few_.data() : many_.data(); }
    T* begin() noexcept { return data(); }
    T* end() noexcept { return data() + size_; }
    const T* begin() const noexcept { return data(); }
    const T* end() const noexcept { return data() + size_; }
    T& operator[](std::size_t k) noexcept { return data()[k]; }
    const T& operator[](std::size_t k) const noexcept { return data()[k]; }
    const T& front() const noexcept { return data()[0]; }
    const T& back() const noexcept { return data()[size_ - 1]; }

    void push_back(const T& value) {
        if (size_ < capacity) {
            few_[size_] = value;
        } else {
            const T added = value;  // it may be one of these
            if (size_ == capacity) many_.assign(few_.begin(), few_.end());
            many_.push_back(added);
        }
        ++size_;
    }
    void clear() noexcept {
        size_ = 0;
        many_.clear();
    }

  private:
    std::size_t size_ = 0;
    std::array<T, capacity> few_{};
    std::vector<T> many_{};  ///< all of them, where they are more
};

}  // namespace lancet::mesh
