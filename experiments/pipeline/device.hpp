#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::experiments::pipeline {

/// What the thread of a force-feedback device saw.
struct DeviceReport {
    std::int64_t due = 0;               ///< ticks that have been due
    std::int64_t missed = 0;            ///< ticks that began more than a period late
    std::int64_t lost = 0;              ///< samples for which there was no room
    double seconds = 0;                 ///< from the first tick to the end of the last
    double largest_force = 0;           ///< N
    std::vector<double> force_seconds;  ///< of each tick: asking for the force
    std::vector<double> latency;  ///< s, of ticks with a force model: age of the latest sample that the model knows
};

/// Stands for a force-feedback device: a thread that ticks at its own rate by the clock, moves the tool along a path
/// and asks for the force, however long the simulation takes for a step.
class Device {
  public:
    /// Starts at `start` on steady_seconds(). The path's samples are those of the ticks.
    Device(runtime::Simulation& simulation, int tool, runtime::ToolPath path, double start);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    /// Ends the thread; what it saw.
    DeviceReport stop();

  private:
    void run();

    runtime::Simulation& simulation_;
    int tool_;
    runtime::ToolPath path_;
    double start_;
    DeviceReport report_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace lancet::experiments::pipeline
