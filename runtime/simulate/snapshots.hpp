#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <utility>

namespace lancet::runtime {

/// The latest of a sequence of values that one thread writes and others read, none of them waiting for another.
///
/// A reader holds what was the latest when it asked; the writer meanwhile goes on with another slot. With more than
/// `slots` - 2 readers on different values the writer may find no free slot: it then leaves the latest as it is.
///
///     if (Value* value = snapshots.begin()) { ...fill *value...; snapshots.publish(); }     // one writer
///     if (const auto latest = snapshots.latest()) use(*latest);                             // anybody
template <class Value, std::size_t slots = 5>
class Snapshots {
    static_assert(slots >= 3);

  public:
    /// Holds a value; it does not change until the last holder is gone.
    class Reader {
      public:
        Reader() = default;
        Reader(Reader&& other) noexcept : slot_(std::exchange(other.slot_, nullptr)) {}
        Reader& operator=(Reader&& other) noexcept {
            std::swap(slot_, other.slot_);
            return *this;
        }
        ~Reader() {
            if (slot_ != nullptr) slot_->readers.fetch_sub(1, std::memory_order_release);
        }

        explicit operator bool() const noexcept { return slot_ != nullptr; }
        const Value& operator*() const noexcept { return slot_->value; }
        const Value* operator->() const noexcept { return &slot_->value; }

      private:
        friend class Snapshots;
        struct Slot {
            Value value{};
            std::atomic<int> readers{0};
        };
        explicit Reader(Slot* slot) : slot_(slot) {}
        Slot* slot_ = nullptr;
    };

    /// The latest value; empty before the first.
    Reader latest() noexcept {
        // Announced first and checked then: either the writer sees the announcement, or the check sees that the slot is
        // no longer the latest. Both sides need one order of all four accesses (memory_order_seq_cst).
        for (;;) {
            const int latest = latest_.load();
            if (latest < 0) return {};
            Slot& slot = slots_[static_cast<std::size_t>(latest)];
            slot.readers.fetch_add(1);
            if (latest_.load() == latest) return Reader(&slot);
            slot.readers.fetch_sub(1);
        }
    }

    /// A slot to be filled, with what it was filled with before; nullptr where readers hold all others.
    Value* begin() noexcept {
        const int latest = latest_.load();
        for (std::size_t slot = 0; slot < slots; ++slot) {
            if (static_cast<int>(slot) == latest || slots_[slot].readers.load() != 0) continue;
            writing_ = static_cast<int>(slot);
            return &slots_[slot].value;
        }
        return nullptr;
    }

    /// Makes the value that was begun the latest.
    void publish() noexcept { latest_.store(writing_); }

  private:
    using Slot = typename Reader::Slot;

    std::array<Slot, slots> slots_;
    std::atomic<int> latest_{-1};
    int writing_ = -1;
};

}  // namespace lancet::runtime
