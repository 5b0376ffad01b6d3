#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "lancet/runtime/simulate/surface.hpp"
#include "lancet/runtime/simulate/tool.hpp"

namespace lancet::runtime {

/// The surfaces of all bodies as a frame shows them: held, not copied, so that they do not change meanwhile. A range of
/// SurfaceShape, in the order of the bodies; one that has not been evaluated yet is empty.
class FrameSurfaces {
  public:
    using Held = SurfaceSnapshots::Reader;

    class Iterator {
      public:
        using iterator_category = std::input_iterator_tag;
        using difference_type = std::ptrdiff_t;
        using value_type = SurfaceShape;
        using pointer = const SurfaceShape*;
        using reference = const SurfaceShape&;

        Iterator() = default;
        Iterator(const FrameSurfaces& surfaces, std::size_t body) : surfaces_(&surfaces), body_(body) {}
        reference operator*() const noexcept { return (*surfaces_)[body_]; }
        pointer operator->() const noexcept { return &(*surfaces_)[body_]; }
        Iterator& operator++() noexcept {
            ++body_;
            return *this;
        }
        Iterator operator++(int) noexcept {
            const Iterator before = *this;
            ++body_;
            return before;
        }
        friend bool operator==(const Iterator&, const Iterator&) = default;

      private:
        const FrameSurfaces* surfaces_ = nullptr;
        std::size_t body_ = 0;
    };

    std::size_t size() const noexcept { return held_.size(); }
    bool empty() const noexcept { return held_.empty(); }
    const SurfaceShape& operator[](std::size_t body) const noexcept { return held_[body] ? *held_[body] : none_; }
    const SurfaceShape& front() const noexcept { return (*this)[0]; }
    Iterator begin() const noexcept { return {*this, 0}; }
    Iterator end() const noexcept { return {*this, size()}; }

    /// Lets go of what it holds, and makes room for so many bodies.
    void reset(std::size_t bodies) {
        held_.resize(bodies);
        for (Held& held : held_) held = {};
    }
    void hold(std::size_t body, Held shape) noexcept { held_[body] = std::move(shape); }

  private:
    std::vector<Held> held_;
    SurfaceShape none_;
};

/// What is to be seen at one time, for as long as somebody looks at it.
struct Frame {
    std::int64_t number = 0;  ///< from 0, dropped ones counted
    std::int64_t step = 0;    ///< world steps that had been taken
    double time = 0;          ///< s
    double input_stamp = 0;   ///< of the latest tool sample that it shows (see ToolSample); 0 without one
    FrameSurfaces bodies;
    std::vector<ToolSample> tools;
};

}  // namespace lancet::runtime
