#include "lancet/runtime/schedule/step_graph.hpp"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

void nothing() {}

template <class Function>
std::string error_message(const Function& function) {
    try {
        function();
    } catch (const Error& error) {
        return error.what();
    }
    return "no lancet::Error was thrown";
}

TEST(StepGraph, WritesItselfInDot) {
    StepGraph graph;
    auto forces = graph.task("forces", nothing);
    auto solve = graph.task("solve", nothing);
    auto frames = graph.task("frames \"x\\y\"", nothing);
    forces.precede(solve, frames);
    forces.precede(solve);
    EXPECT_EQ(graph.size(), 3);
    EXPECT_EQ(forces.name(), "forces");
    EXPECT_EQ(graph.to_dot(), R"(digraph step {
    "forces";
    "solve";
    "frames \"x\\y\"";
    "forces" -> "solve";
    "forces" -> "frames \"x\\y\"";
}
)");
}

TEST(StepGraph, NamesTheTasksOnACycleAndNoOthers) {
    StepGraph graph;
    auto before = graph.task("before", nothing);
    auto a = graph.task("a", nothing);
    auto b = graph.task("b", nothing);
    auto c = graph.task("c", nothing);
    auto after = graph.task("after", nothing);
    before.precede(a);
    a.precede(b);
    b.precede(c);
    c.precede(a, after);
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    for (const std::string& message :
         {error_message([&] { graph.validate(); }), error_message([&] { graph.run(*scheduler); })}) {
        EXPECT_THAT(message, HasSubstr("'a' -> 'b' -> 'c' -> 'a'"));
        EXPECT_THAT(message, AllOf(Not(HasSubstr("before")), Not(HasSubstr("after"))));
    }
}

TEST(StepGraph, RefusesATaskThatWaitsForItself) {
    StepGraph graph;
    auto alone = graph.task("alone", nothing);
    alone.precede(alone);
    EXPECT_THAT(error_message([&] { graph.validate(); }), HasSubstr("'alone' -> 'alone'"));
}

TEST(StepGraph, RefusesDuplicateNamesMissingNamesAndMissingBodies) {
    StepGraph graph;
    graph.task("solve", nothing);
    EXPECT_THAT(error_message([&] { graph.task("solve", nothing); }), HasSubstr("'solve'"));
    EXPECT_THAT(error_message([&] { graph.task("", nothing); }), HasSubstr("needs a name"));
    EXPECT_THAT(error_message([&] { graph.task("empty", {}); }), HasSubstr("'empty' has no body"));
    EXPECT_EQ(graph.size(), 1);
}

TEST(StepGraph, RefusesEdgesToAnotherGraph) {
    StepGraph one;
    StepGraph other;
    auto a = one.task("a", nothing);
    auto b = other.task("b", nothing);
    EXPECT_THAT(error_message([&] { a.precede(b); }), HasSubstr("another graph"));
}

TEST(StepGraph, CanBeMovedWithItsHandles) {
    std::string order;
    StepGraph original;
    auto a = original.task("a", [&] { order += 'a'; });
    StepGraph graph = std::move(original);
    auto b = graph.task("b", [&] { order += 'b'; });
    b.precede(a);
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    graph.run(*scheduler);
    EXPECT_EQ(order, "ba");
}

TEST(StepGraph, RunsSeriallyInAFixedOrder) {
    std::string order;
    StepGraph graph;
    auto d = graph.task("d", [&] { order += 'd'; });
    auto c = graph.task("c", [&] { order += 'c'; });
    auto b = graph.task("b", [&] { order += 'b'; });
    auto a = graph.task("a", [&] { order += 'a'; });
    a.precede(b, c);
    b.precede(d);
    c.precede(d);
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    graph.run(*scheduler);
    graph.run(*scheduler);
    EXPECT_EQ(order, "acbdacbd");
}

}  // namespace
}  // namespace lancet::runtime
