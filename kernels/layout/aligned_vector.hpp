#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace lancet::kernels {

/// Allocates on cache-line boundaries, so that no vector load of a batch crosses two lines.
template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{64};

    CacheLineAllocator() = default;
    template <class Other>
    CacheLineAllocator(const CacheLineAllocator<Other>&) noexcept {}

    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
    void deallocate(T* memory, std::size_t) noexcept { ::operator delete(memory, alignment); }

    template <class Other>
    bool operator==(const CacheLineAllocator<Other>&) const noexcept {
        return true;
    }
};

/// A std::vector whose data starts on a cache line.
template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

/// Bytes that a vector holds on the heap.
template <class T, class Allocator>
std::size_t heap_bytes(const std::vector<T, Allocator>& vector) noexcept {
    return vector.capacity() * sizeof(T);
}

}  // namespace lancet::kernels
