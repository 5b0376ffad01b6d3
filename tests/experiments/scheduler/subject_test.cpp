#include "lancet/experiments/scheduler/subject.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scheduler {
namespace {

// The tool of `everything` must not touch, and a body that can be cut must move as one that cannot.
TEST(Subject, AllFormsMoveAlike) {
    const BarProblem problem{.cells = {10, 2, 2}};
    EXPECT_EQ(problem.elements(), 200);
    const auto serial = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const auto reference = make_loops(problem, *serial);
    const auto at_rest = reference->positions();
    constexpr int steps = 60;
    for (int step = 0; step < steps; ++step) reference->step();
    const auto expected = reference->positions();
    EXPECT_NE(expected, at_rest);
    for (const runtime::SchedulerKind kind : runtime::available_schedulers()) {
        const auto scheduler = runtime::make_scheduler(kind, 2);
        std::vector<std::unique_ptr<Subject>> subjects;
        subjects.push_back(make_loops(problem, *scheduler));
        for (const Extras extras : {Extras::nothing, Extras::frames, Extras::everything}) {
            subjects.push_back(make_tasks(problem, *scheduler, extras));
        }
        for (const auto& subject : subjects) {
            for (int step = 0; step < steps; ++step) subject->step();
            EXPECT_EQ(subject->positions(), expected) << to_string(kind);
        }
    }
}

TEST(Subject, TellsWhatItsTasksTook) {
    const BarProblem problem{.cells = {10, 2, 2}};
    const auto serial = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const auto loops = make_loops(problem, *serial);
    loops->step();
    EXPECT_EQ(loops->task_seconds().all, 0);
    EXPECT_EQ(loops->graph(), "");
    for (const Extras extras : {Extras::frames, Extras::everything}) {
        const auto subject = make_tasks(problem, *serial, extras);
        for (int step = 0; step < 3; ++step) {
            subject->step();
            const TaskSeconds seconds = subject->task_seconds();
            EXPECT_GT(seconds.frames, 0);
            EXPECT_EQ(seconds.frames_beside, 0);
            EXPECT_GT(seconds.side, seconds.frames);
            EXPECT_GT(seconds.all, seconds.side);
        }
        const bool has_tool = extras == Extras::everything;
        for (const std::string task : {"tool collision", "bar: cut", "input", "force feedback"}) {
            EXPECT_EQ(subject->graph().find(task) != std::string::npos, has_tool) << task;
        }
    }
}

TEST(Subject, NamesExtras) {
    for (const Extras extras : {Extras::nothing, Extras::frames, Extras::everything}) {
        EXPECT_EQ(extras_from_string(to_string(extras)), extras);
    }
    EXPECT_THROW(extras_from_string("all"), Error);
}

}  // namespace
}  // namespace lancet::experiments::scheduler
