#include "lancet/runtime/observe/trace.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/atomic_file.hpp"

namespace lancet::runtime {

Trace::Trace(std::size_t capacity) : events_(capacity) {
    if (capacity == 0) throw Error("trace: no room for a task; expected a capacity of at least 1");
}

void Trace::ended(int, std::string_view name, double begin, double end) noexcept {
    // Threads are numbered as they come, over all traces of the program: the number belongs to the thread.
    static std::atomic<std::uint32_t> known_threads{0};
    thread_local const std::uint32_t thread = known_threads.fetch_add(1, std::memory_order_relaxed);
    const std::size_t place = next_.fetch_add(1, std::memory_order_relaxed);
    if (place < events_.size()) events_[place] = {name, begin, end, thread};
}

std::size_t Trace::recorded() const noexcept {
    return std::min(next_.load(), events_.size());
}

std::size_t Trace::lost() const noexcept {
    return next_.load() - recorded();
}

std::string Trace::json() const {
    std::vector<Event> events(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(recorded()));
    std::ranges::stable_sort(events, {}, &Event::begin);
    const double start = events.empty() ? 0 : events.front().begin;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Event& event : events) {
        list.push_back({{"name", event.name},
                        {"ph", "X"},
                        {"ts", 1e6 * (event.begin - start)},
                        {"dur", 1e6 * (event.end - event.begin)},
                        {"pid", 1},
                        {"tid", event.thread}});
    }
    return nlohmann::ordered_json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(list)}}.dump(0) + "\n";
}

void Trace::write(const std::filesystem::path& file) const {
    mesh::io::AtomicFile out(file);
    out << json();
    out.commit();
}

}  // namespace lancet::runtime
