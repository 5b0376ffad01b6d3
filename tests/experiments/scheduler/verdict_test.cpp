#include "lancet/experiments/scheduler/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/experiments/scheduler/tables.hpp"

namespace lancet::experiments::scheduler {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Measured row(const std::string& form, const Spread& to_serial, Extras extras = Extras::nothing, int threads = 2) {
    return {.elements = 1600,
            .threads = threads,
            .form = form,
            .extras = extras,
            .seconds = {1e-3, 2e-3},
            .to_serial = to_serial,
            .to_bare = to_serial,
            .tasks = form == "graph" ? 4 : 0,
            .bit_identical = true};
}

TEST(Verdict, NamesTheFastestWhicheverItIs) {
    const std::vector rows{row("graph", {0.8, 0.82, 0.85}), row("openmp-loops", {0.5, 0.52, 0.55}),
                           row("loops", {0.54, 0.56, 0.6})};
    const auto lines = verdict(rows, {});
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_THAT(lines[0], AllOf(HasSubstr("loops on OpenMP first, but within the noise of phases of loops"),
                                HasSubstr("slower: the flow graph (+58 %)")));
    EXPECT_THAT(lines[1], HasSubstr("to the bit"));
}

TEST(Verdict, AFormThatIsAlwaysFasterIsTheFastest) {
    const std::vector rows{row("graph", {0.4, 0.42, 0.49}), row("loops", {0.5, 0.52, 0.55})};
    EXPECT_THAT(verdict(rows, {})[0], AllOf(HasSubstr("fastest is the flow graph"), Not(HasSubstr("noise"))));
}

TEST(Verdict, WhatTheSameCodeMayDifferByIsNoise) {
    const std::vector rows{row("serial", {1, 1, 1}, Extras::nothing, 1),
                           row("loops", {0.98, 0.985, 0.99}, Extras::nothing, 1),
                           row("openmp-loops", {1.02, 1.03, 1.04}, Extras::nothing, 1)};
    EXPECT_THAT(verdict(rows, {})[0],
                AllOf(HasSubstr("within the noise of the serial step (+1.5 %)"), HasSubstr("slower: loops on OpenMP")));
}

TEST(Verdict, SaysWhereBitsDiffer) {
    std::vector rows{row("graph", {0.4, 0.42, 0.49})};
    rows[0].bit_identical = false;
    EXPECT_THAT(verdict(rows, {}).back(), HasSubstr("1 rows end at other positions"));
    EXPECT_EQ(std::get<std::string>(form_table(rows).rows()[0].back()), "no");
}

TEST(Target, IsMetWhereAllRepetitionsAgree) {
    Target target{.bound = 3};
    target.percent = {1, 2, 2.9};
    EXPECT_EQ(target.is_met(), "yes");
    target.percent = {1, 2, 3.1};
    EXPECT_EQ(target.is_met(), "within noise");
    target.percent = {3.1, 4, 5};
    EXPECT_EQ(target.is_met(), "no");
    target.is_at_most = false;
    EXPECT_EQ(target.is_met(), "yes");
}

TEST(Target, AreThoseOfTheRowsThatWereMeasured) {
    std::vector rows{row("graph", {1.0, 1.005, 1.01}, Extras::nothing, 1),
                     row("graph", {1.1, 1.2, 1.3}, Extras::everything, 1),
                     row("graph", {0.6, 0.6, 0.6}, Extras::frames)};
    rows[2].hidden = {0.7, 0.75, 0.85};
    rows[2].beside = {0.9, 0.9, 0.9};
    rows[2].hidden_at_most = {0.8, 0.8, 0.8};
    const auto found = targets(rows);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_NEAR(found[0].percent.middle, 20, 1e-9);
    EXPECT_EQ(found[0].is_met(), "no");
    EXPECT_EQ(found[1].is_met(), "within noise");
    EXPECT_NEAR(found[1].percent.middle, 75, 1e-9);
    EXPECT_NEAR(found[2].percent.middle, 0.5, 1e-9);
    const auto lines = verdict(rows, found);
    EXPECT_THAT(lines, testing::Contains(AllOf(HasSubstr("everything on"), HasSubstr("missed in 1"))));
    EXPECT_THAT(lines, testing::Contains(AllOf(HasSubstr("90 to 90 % ran beside"), HasSubstr("80 to 80 % can be"))));
    EXPECT_EQ(target_table(found).rows().size(), 3U);
}

TEST(Measured, ComparesTheSameStepsOfOneProcess) {
    // A disturbance that doubles one step of all subjects changes no ratio.
    WorkerReport report{.motion = "m"};
    for (const double factor : {1.0, 0.5, 0.6, 0.9, 1.2}) {
        SubjectReport subject{.bit_identical = true};
        for (const double seconds : {1.0, 2.0, 1.0}) {
            subject.seconds.push_back(factor * seconds);
            subject.frame_seconds.push_back(0.4 * seconds);
            subject.frame_seconds_beside.push_back(0.3 * seconds);
            subject.side_seconds.push_back(0.45 * seconds);
            subject.task_seconds.push_back(factor * seconds);
        }
        report.subjects.push_back(subject);
    }
    for (std::size_t k = 2; k < 5; ++k) {
        report.subjects[k].is_tasks = true;
        report.subjects[k].tasks = 5;
        report.subjects[k].extras = to_string(k == 2 ? Extras::nothing : k == 3 ? Extras::frames : Extras::everything);
    }
    const WorkerJob job{.kind = runtime::SchedulerKind::tbb, .threads = 2};
    const std::vector reports{report, report};
    const auto rows = evaluate(job, reports, "m");
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_EQ(rows[0].form, "loops");
    EXPECT_EQ(rows[0].seconds.size(), 6U);
    EXPECT_NEAR(rows[0].to_serial.middle, 0.5, 1e-12);
    EXPECT_NEAR(rows[1].to_bare.middle, 1.2, 1e-12);
    EXPECT_NEAR(rows[2].hidden.middle, 1 - 0.3 / 0.4, 1e-12);
    EXPECT_NEAR(rows[2].beside.middle, 0.75, 1e-12);
    EXPECT_NEAR(rows[2].hidden_at_most.middle, 0.6, 1e-12);
    EXPECT_TRUE(rows[3].bit_identical);
    EXPECT_FALSE(evaluate(job, reports, "n")[3].bit_identical);
}

TEST(Measured, ComparesWindowsOfStepsWhereFramesAreRare) {
    // Every third step has a frame, which adds a step's time of which nothing is hidden.
    WorkerReport report{.motion = "m"};
    for (const Extras extras : {Extras::nothing, Extras::nothing, Extras::nothing, Extras::frames}) {
        SubjectReport subject{.extras = std::string(to_string(extras)), .bit_identical = true};
        for (int step = 0; step < 6; ++step) {
            const double frame = extras == Extras::frames && step % 3 == 0 ? 1 : 0;
            subject.seconds.push_back(1 + frame);
            subject.frame_seconds.push_back(frame);
            subject.frame_seconds_beside.push_back(0);
            subject.side_seconds.push_back(frame);
            subject.task_seconds.push_back(1 + frame);
        }
        report.subjects.push_back(subject);
    }
    for (std::size_t k = 2; k < 4; ++k) report.subjects[k].is_tasks = true;
    const WorkerJob job{.kind = runtime::SchedulerKind::tbb, .threads = 2, .window = 3};
    const auto rows = evaluate(job, std::vector{report}, "m");
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_NEAR(rows[2].to_bare.middle, 4.0 / 3, 1e-12);
    EXPECT_NEAR(rows[2].frames.middle, 1.0 / 3, 1e-12);
    EXPECT_NEAR(rows[2].side.middle, 1.0 / 3, 1e-12);
    EXPECT_NEAR(rows[2].hidden.middle, 0, 1e-12);
}

}  // namespace
}  // namespace lancet::experiments::scheduler
