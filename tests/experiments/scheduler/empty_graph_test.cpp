#include "lancet/experiments/scheduler/empty_graph.hpp"

#include <gtest/gtest.h>

#include "lancet/experiments/scheduler/subject.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scheduler {
namespace {

TEST(EmptyGraph, HasTheTasksAndEdgesOfTheStep) {
    const auto serial = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const Extras extras : {Extras::nothing, Extras::frames, Extras::everything}) {
        const auto subject = make_tasks({.cells = {4, 1, 1}}, *serial, extras);
        runtime::StepGraph graph = empty_graph(subject->graph());
        EXPECT_EQ(graph.to_dot(), subject->graph());
        EXPECT_GT(graph.size(), 3);
        EXPECT_GT(seconds_of_run(graph, *serial, 5), 0);
    }
}

TEST(EmptyGraph, RefusesOtherText) {
    EXPECT_THROW(empty_graph(""), Error);
    EXPECT_THROW(empty_graph("digraph step {\n    \"a;\n}\n"), Error);
    EXPECT_THROW(empty_graph("digraph step {\n    \"a\" -> \"b\";\n}\n"), Error);
}

}  // namespace
}  // namespace lancet::experiments::scheduler
