#include "lancet/experiments/pipeline/soak.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <malloc.h>

#include "lancet/experiments/common/hash.hpp"
#include "lancet/experiments/pipeline/world.hpp"
#include "lancet/runtime/observe/memory.hpp"

namespace lancet::experiments::pipeline {

namespace {

constexpr double life = 6;     ///< simulated seconds between resets
constexpr double strokes = 1;  ///< of it that are the same in each life

/// Random places in and around the body, with random actions, at random speed; the same numbers on every machine.
runtime::ToolPath random_path(const World& world, double begin, double end, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
    };
    runtime::ToolPath path;
    double time = begin;
    while (time < end) {
        runtime::ToolSample sample{.time = time};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double size = world.upper[axis] - world.lower[axis];
            sample.pose.position[axis] = world.lower[axis] + uniform(-0.2, 1.2) * size;
        }
        double length = 0;
        for (double& value : sample.pose.orientation) {
            value = uniform(-1, 1);
            length += value * value;
        }
        if (length < 1e-3) continue;
        for (double& value : sample.pose.orientation) value /= std::sqrt(length);
        const double choice = uniform(0, 1);
        sample.action = choice < 0.4   ? runtime::ToolAction::touch
                        : choice < 0.7 ? runtime::ToolAction::grab
                        : choice < 0.8 ? runtime::ToolAction::cut
                                       : runtime::ToolAction::idle;
        path.push_back(sample);
        time += uniform(0.05, 0.6);
    }
    return path;
}

double largest_speed(const runtime::DeformableBody& body, std::vector<Point>& velocities) {
    velocities.resize(body.nodes());
    body.velocities(velocities);
    double largest = 0;
    for (const Point& v : velocities) {
        const double speed = std::hypot(v[0], v[1], v[2]);
        if (!std::isfinite(speed)) return speed;
        largest = std::max(largest, speed);
    }
    return largest;
}

SoakRound live(const PipelineSettings& settings, runtime::Scheduler& scheduler, std::int64_t round, double seconds) {
    SoakRound result{.round = round, .seconds = seconds};
    World world = make_world(settings, scheduler);
    runtime::Simulation& simulation = *world.simulation;
    simulation.keep_surfaces();
    runtime::ToolPath path = random_path(world, 0, strokes, settings.seed);
    const runtime::ToolPath rest = random_path(
        world, strokes, seconds, settings.seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(round + 1));
    path.insert(path.end(), rest.begin(), rest.end());
    simulation.play(world.tool, runtime::resampled(path, settings.time_step));
    std::vector<Point> scratch;
    const auto steps = std::llround(seconds / settings.time_step), fixed = std::llround(strokes / settings.time_step);
    for (std::int64_t step = 0; step < steps; ++step) {
        simulation.step();
        runtime::SimulatedBody& body = simulation.body(world.body);
        const double speed = largest_speed(body.body(), scratch);
        if (!std::isfinite(speed)) result.is_finite = false;
        result.largest_speed = std::max(result.largest_speed, speed);
        // The same strokes end where the first sample of the others begins to pull.
        if (step + 1 == std::min(steps, fixed / 2)) {
            scratch.resize(body.body().nodes());
            body.body().positions(scratch);
            Hash hash;
            hash.add(std::span<const Point>(scratch));
            result.fingerprint = hash.text();
        }
    }
    result.cuts = simulation.cut_statistics().cuts;
    result.copies = simulation.cut_statistics().copies;
    result.lost_steps = simulation.body(world.body).lost_steps();
    return result;
}

}  // namespace

Soak run_soak(const PipelineSettings& settings, Progress& progress) {
    const auto scheduler = runtime::make_scheduler(settings.scheduler, settings.threads);
    const double seconds = 60 * *settings.soak;
    Soak soak;
    for (double done = 0; done < seconds - 1e-9; done += life) {
        const auto round = static_cast<std::int64_t>(soak.rounds.size());
        progress.show("soak: " + std::to_string(static_cast<int>(done)) + " of " +
                      std::to_string(static_cast<int>(seconds)) + " s, life " + std::to_string(round + 1));
        soak.rounds.push_back(live(settings, *scheduler, round, std::min(life, std::max(strokes, seconds - done))));
        // What the allocator keeps for later is no leak.
        malloc_trim(0);
        SoakRound& last = soak.rounds.back();
        last.memory_mbytes = static_cast<double>(runtime::resident_memory().current) / 1e6;
        const std::string of = "life " + std::to_string(round) + ": ";
        if (!last.is_finite) soak.complaints.push_back(of + "a state is not finite");
        if (last.fingerprint != soak.rounds.front().fingerprint) {
            soak.complaints.push_back(of + "the same strokes came to other positions than in the first life");
        }
    }
    // The first lives warm up pools of threads and of the allocator.
    if (soak.rounds.size() >= 6) {
        const auto mean = [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t k = begin; k < end; ++k) sum += soak.rounds[k].memory_mbytes;
            return sum / static_cast<double>(end - begin);
        };
        const std::size_t third = soak.rounds.size() / 3;
        const double early = mean(third, 2 * third), late = mean(2 * third, soak.rounds.size());
        if (late > 1.05 * early + 4) {
            soak.complaints.push_back("memory grew from " + format_number(early, 4) + " to " + format_number(late, 4) +
                                      " MB between the middle and the last third of the lives");
        }
    }
    progress.clear();
    return soak;
}

Table soak_table(const Soak& soak) {
    Table table({{"life", "life"},
                 {"seconds", "simulated", "s"},
                 {"cuts", "cuts"},
                 {"copies", "copies"},
                 {"lost_steps", "lost steps"},
                 {"largest_speed", "largest speed", "m/s"},
                 {"memory_mbytes", "memory", "MB", 4},
                 {"fingerprint", "after the same strokes"}});
    for (const SoakRound& round : soak.rounds) {
        table.add_row({round.round, round.seconds, round.cuts, round.copies, round.lost_steps, round.largest_speed,
                       round.memory_mbytes, round.fingerprint});
    }
    return table;
}

}  // namespace lancet::experiments::pipeline
