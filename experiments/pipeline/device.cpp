#include "lancet/experiments/pipeline/device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lancet/experiments/pipeline/pace.hpp"

namespace lancet::experiments::pipeline {

Device::Device(runtime::Simulation& simulation, int tool, runtime::ToolPath path, double start)
    : simulation_(simulation), tool_(tool), path_(std::move(path)), start_(start) {
    report_.force_seconds.reserve(path_.size());
    report_.latency.reserve(path_.size());
    thread_ = std::thread([this] { run(); });
}

Device::~Device() {
    stop();
}

DeviceReport Device::stop() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
    return report_;
}

void Device::run() {
    for (std::size_t k = 0; k < path_.size() && !ends_; ++k) {
        const double due = start_ + path_[k].time;
        sleep_until(due);
        const double begin = runtime::steady_seconds();
        const double period = k + 1 < path_.size() ? path_[k + 1].time - path_[k].time : 0;
        ++report_.due;
        if (begin - due > period) ++report_.missed;
        if (!simulation_.move(tool_, path_[k].pose, path_[k].action)) ++report_.lost;
        const runtime::Wrench wrench = simulation_.force(tool_, path_[k].pose);
        const double end = runtime::steady_seconds();
        report_.force_seconds.push_back(end - begin);
        report_.largest_force =
            std::max(report_.largest_force, std::hypot(wrench.force[0], wrench.force[1], wrench.force[2]));
        if (const auto model = simulation_.latest_forces(tool_); model && model->input_stamp > 0) {
            report_.latency.push_back(end - model->input_stamp);
        }
        report_.seconds = end - start_;
    }
}

}  // namespace lancet::experiments::pipeline
