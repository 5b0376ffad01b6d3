#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lancet/runtime/observe/task_observer.hpp"

namespace lancet::runtime {

/// What ran when on which thread, for chrome://tracing and ui.perfetto.dev. Recording takes no lock and allocates
/// nothing.
class Trace final : public TaskObserver {
  public:
    /// Keeps the first `capacity` tasks, and counts the others.
    explicit Trace(std::size_t capacity);

    void ended(int task, std::string_view name, double begin, double end) noexcept override;

    std::size_t recorded() const noexcept;
    /// Tasks that had no place.
    std::size_t lost() const noexcept;

    /// In the trace event format (complete events, microseconds since the first), by start. Call when nothing records.
    std::string json() const;
    /// Writes json() to a file, which appears by rename. Throws lancet::Error where it cannot be written.
    void write(const std::filesystem::path& file) const;

  private:
    struct Event {
        std::string_view name;  ///< of the observed simulation, or a literal
        double begin = 0, end = 0;
        std::uint32_t thread = 0;
    };

    std::vector<Event> events_;
    std::atomic<std::size_t> next_{0};
};

}  // namespace lancet::runtime
