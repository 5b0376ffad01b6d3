#include "lancet/experiments/scheduler/worker.hpp"

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scheduler {
namespace {

TEST(Worker, TimesEveryStepOfEverySubject) {
    const WorkerReport report = measure(
        {.problem = {.cells = {10, 2, 2}}, .kind = runtime::SchedulerKind::serial, .runs = 2, .steps = 7, .block = 3});
    ASSERT_EQ(report.subjects.size(), 4U);
    for (const SubjectReport& subject : report.subjects) {
        EXPECT_EQ(subject.seconds.size(), 14U);
        EXPECT_EQ(subject.task_seconds.size(), 14U);
        for (const double seconds : subject.seconds) EXPECT_GT(seconds, 0);
        EXPECT_TRUE(subject.bit_identical);
        EXPECT_EQ(subject.tasks > 0, subject.is_tasks);
    }
    EXPECT_LT(report.subjects[1].tasks, report.subjects[2].tasks);
    EXPECT_LT(report.subjects[2].tasks, report.subjects[3].tasks);

    const WorkerReport again = report_from_line(to_line(report));
    EXPECT_EQ(again.motion, report.motion);
    ASSERT_EQ(again.subjects.size(), report.subjects.size());
    EXPECT_EQ(again.subjects[3].extras, "everything");
    EXPECT_EQ(again.subjects[3].seconds, report.subjects[3].seconds);
    EXPECT_EQ(again.subjects[3].empty_graph_seconds, report.subjects[3].empty_graph_seconds);
}

TEST(Worker, ItsReportIsJson) {
    EXPECT_THROW(report_from_line("no report"), Error);
    EXPECT_THROW(report_from_line("{}"), Error);
}

}  // namespace
}  // namespace lancet::experiments::scheduler
