#include "lancet/experiments/skips/runner.hpp"

#include <malloc.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::skips {
namespace {

class BodyRunner final : public Runner {
  public:
    BodyRunner(const runtime::Scene& scene, const runtime::Settings& settings)
        : body_(make_body(scene, settings, one_thread())) {}

    double advance() override {
        const double begin = runtime::steady_seconds();
        body_->step(one_thread());
        return runtime::steady_seconds() - begin;
    }
    std::vector<mesh::Point> positions() override {
        std::vector<mesh::Point> positions(body_->nodes());
        body_->positions(positions);
        return positions;
    }
    std::optional<double> bytes() const override { return static_cast<double>(body_->bytes()); }
    runtime::DeformableBody& body() { return *body_; }

  private:
    std::unique_ptr<runtime::DeformableBody> body_;
};

class WorldRunner final : public Runner {
  public:
    WorldRunner(const runtime::SimulationOptions& options, const std::function<void(runtime::Simulation&)>& describe,
                int steps, int settle)
        : simulation_(one_thread(), options), steps_(steps) {
        const std::size_t before = heap_bytes();
        describe(simulation_);
        bytes_ = static_cast<double>(heap_bytes()) - static_cast<double>(before);
        for (int step = 0; step < settle; ++step) simulation_.step();
    }

    double advance() override {
        const double begin = runtime::steady_seconds();
        for (int step = 0; step < steps_; ++step) simulation_.step();
        return runtime::steady_seconds() - begin;
    }
    std::vector<mesh::Point> positions() override {
        std::vector<mesh::Point> all;
        for (int number = 0; number < simulation_.bodies(); ++number) {
            const runtime::DeformableBody& body = simulation_.body(number).body();
            const std::size_t first = all.size();
            all.resize(first + body.nodes());
            body.positions(std::span(all).subspan(first));
        }
        return all;
    }
    std::optional<double> bytes() const override { return bytes_; }

  private:
    runtime::Simulation simulation_;
    int steps_;
    double bytes_ = 0;
};

}  // namespace

runtime::Scheduler& one_thread() {
    static const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    return *scheduler;
}

runtime::Scene bar(bool is_quick) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = is_quick ? std::array{20, 4, 4} : std::array{40, 8, 8}, .size = {4, 0.8, 0.8}});
    const auto clamped = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(clamped.begin(), clamped.end());
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100}}};
    return scene;
}

std::unique_ptr<Runner> run_body(const runtime::Scene& scene, const runtime::Settings& settings,
                                 const std::function<void(runtime::DeformableBody&)>& before) {
    auto runner = std::make_unique<BodyRunner>(scene, settings);
    if (before) before(runner->body());
    return runner;
}

std::unique_ptr<Runner> run_world(const runtime::SimulationOptions& options,
                                  const std::function<void(runtime::Simulation&)>& describe, int steps, int settle) {
    return std::make_unique<WorldRunner>(options, describe, steps, settle);
}

std::size_t heap_bytes() noexcept {
    const auto heap = ::mallinfo2();
    return heap.uordblks + heap.hblkhd;
}

}  // namespace lancet::experiments::skips
