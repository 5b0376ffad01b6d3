#include "lancet/experiments/scaling/plan.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lancet::experiments::scaling {
namespace {

ScalingSettings some_settings() {
    ScalingSettings settings;
    settings.series = {"strong"};
    settings.benchmarks = {"bar"};
    settings.elements = {1600};
    settings.threads = {1, 2, 4};
    settings.schedulers = {"openmp", "tbb"};
    settings.instruction_sets = {"avx2", "scalar"};
    settings.scalars = {"float", "mixed", "double"};
    settings.operators = {"edge-blocks", "matrix-free", "block-rows"};
    settings.scatters = {"private-copies", "coloring", "node-gather"};
    settings.steps = 25;
    settings.repetitions = 1;
    return settings;
}

TEST(Plan, ComparesEveryRowWithTheRightOnes) {
    ScalingSettings settings = some_settings();
    settings.series = {"strong", "weak"};
    const Plan plan = make_plan(settings);
    int strong = 0, weak = 0;
    for (const Entry& entry : plan.entries) {
        const Job& job = plan.jobs[entry.job];
        const Job& one = plan.jobs[entry.one_thread];
        const Job& natural = plan.jobs[entry.natural_order];
        const Job& same = plan.jobs[entry.same_blocks];
        EXPECT_TRUE(natural.is_natural_order);
        EXPECT_EQ(natural.elements, 1600);
        EXPECT_EQ(one.elements, 1600);
        EXPECT_EQ(one.threads, 1);
        EXPECT_EQ(one.scheduler, job.scheduler);
        EXPECT_EQ(one.is_natural_order, job.is_natural_order);
        EXPECT_EQ(same.elements, job.elements);
        EXPECT_EQ(same.scheduler, "serial");
        EXPECT_EQ(same.scatter, job.scatter);
        const bool is_weak = entry.series == "weak";
        EXPECT_EQ(job.elements, is_weak ? 1600 * job.threads : 1600);
        ++(is_weak ? weak : strong);
    }
    EXPECT_EQ(strong, 2 + 2 * 3);  // natural order, serial, two schedulers on three counts
    EXPECT_EQ(weak, strong);
    // Jobs that two series show are there once.
    for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
        EXPECT_EQ(std::ranges::count(plan.jobs, plan.jobs[i]), 1) << plan.jobs[i].label();
    }
}

TEST(Plan, VariesOneChoiceAtATimeUnlessAsked) {
    ScalingSettings settings = some_settings();
    settings.varies_one_by_one = true;
    settings.series = {"variants"};
    settings.schedulers = {};
    std::set<std::string> serial;
    for (const Job& job : make_plan(settings).jobs) {
        if (!job.is_natural_order) serial.insert(job.isa + job.scalar + job.matrix + job.scatter);
    }
    EXPECT_EQ(serial.size(), 1U + 1 + 2 + 2 + 2);

    settings.varies_one_by_one = false;
    settings.series = {"strong", "variants"};
    serial.clear();
    for (const Job& job : make_plan(settings).jobs) {
        if (!job.is_natural_order) serial.insert(job.isa + job.scalar + job.matrix + job.scatter);
    }
    EXPECT_EQ(serial.size(), 2U * 3 * 3 * 3);
}

TEST(Plan, TheThesisIsItsOwnDefinition) {
    ScalingSettings settings = some_settings();
    settings.series = {"thesis"};
    settings.benchmarks = {"bar", "organ"};
    const Plan plan = make_plan(settings);
    std::set<int> elements;
    for (const Job& job : plan.jobs) {
        elements.insert(job.elements);
        EXPECT_EQ(job.setting, "original");
        EXPECT_EQ(job.steps, 125);
        EXPECT_THAT(worker_arguments(job), testing::IsSupersetOf({"--linearise=state", "--rotation-interval=5",
                                                                  "--preconditioner=none", "--cg-iterations=10"}));
    }
    EXPECT_EQ(elements, (std::set<int>{12'800, 20'870}));
}

}  // namespace
}  // namespace lancet::experiments::scaling
