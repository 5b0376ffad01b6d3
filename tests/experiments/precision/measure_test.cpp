// What is measured, and what is left out and why.

#include "lancet/experiments/precision/measure.hpp"

#include <filesystem>
#include <limits>
#include <sstream>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/experiments/common/peak_memory.hpp"
#include "lancet/experiments/precision/diagram.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::precision {
namespace {

Case run_of(const std::string& name, double seconds, double position, std::size_t elements = 1) {
    Setting setting;
    setting.series = name;
    return {setting, elements, name, 2, [=] {
                Solution solution;
                solution.seconds = seconds;
                solution.positions = {{position, 0, 0}};
                return solution;
            }};
}

Study study(std::vector<Case> cases) {
    return {.problem = "p", .variant = "", .cases = std::move(cases), .judge = [](const Setting&, const Solution& s) {
                Errors errors;
                errors.l2 = s.positions.front()[0];
                return errors;
            }};
}

Results measured(const Study& of, const Effort& effort) {
    std::ostringstream nowhere;
    Progress progress(nowhere, 0);
    Results results;
    measure(of, effort, progress, results);
    return results;
}

TEST(Measure, MarksTheFrontAndRepeatsRoundRobin) {
    int calls = 0;
    Case counted = run_of("counted", 1, 2);
    counted.run = [&calls, run = counted.run] {
        Solution solution = run();
        solution.seconds = ++calls;
        return solution;
    };
    const Results results = measured(study({counted, run_of("slow", 50, 1), run_of("beaten", 60, 1)}),
                                     {.repetitions = 3, .longest_seconds = 100, .repeat_seconds = 10});
    EXPECT_TRUE(results.omissions.empty());
    ASSERT_EQ(results.rows.size(), 3u);
    EXPECT_EQ(calls, 3);
    EXPECT_EQ(results.rows[0].seconds, 2);  // the median
    EXPECT_EQ(results.rows[0].seconds_maximum, 3);
    EXPECT_EQ(results.rows[0].repetitions, 3);
    EXPECT_EQ(results.rows[1].repetitions, 1);
    EXPECT_TRUE(results.rows[0].pareto);
    EXPECT_TRUE(results.rows[1].pareto);
    EXPECT_FALSE(results.rows[2].pareto);
}

TEST(Measure, SaysWhatItLeavesOut) {
    Case refused = run_of("refused", 1, 1);
    refused.run = []() -> Solution { throw Error("a bad setting"); };
    Case lost = run_of("lost", 1, 1);
    lost.run = []() -> Solution { throw RunFailed("lost stability", "at 0.5 of the load"); };
    Case reserved = run_of("reserved", 1, 1);
    reserved.run = [run = reserved.run] {
        Solution solution = run();
        solution.outcome = "stagnated: so far";
        return solution;
    };
    const Results results =
        measured(study({refused, lost, reserved, run_of("nan", 1, std::numeric_limits<double>::quiet_NaN()),
                        run_of("far", 1, 101), run_of("growing", 3, 1, 10), run_of("growing", 3, 1, 100)}),
                 {.repetitions = 1, .longest_seconds = 100});
    ASSERT_EQ(results.rows.size(), 2u);
    std::vector<std::string> kinds;
    for (const Omission& one : results.omissions) kinds.push_back(one.kind);
    EXPECT_THAT(kinds, testing::ElementsAre("refused", "lost stability", "diverged", "inaccurate", "too slow",
                                            "kept with a reservation"));
    EXPECT_EQ(results.omissions[0].explanation, "a bad setting");
    EXPECT_THAT(results.omissions[4].explanation, testing::HasSubstr("300 s expected"));
}

TEST(Measure, HasAFrontForEachNumberOfThreads) {
    Case two = run_of("two", 2, 2);
    two.setting.threads = 2;
    const Results results = measured(study({run_of("one", 1, 1), two}), {.repetitions = 1});
    EXPECT_TRUE(results.rows[0].pareto);
    EXPECT_TRUE(results.rows[1].pareto);
}

TEST(PeakMemory, SeesWhatIsTouchedAndGivenBack) {
    constexpr std::size_t size = 64u << 20;
    const PeakMemory meter;
    if (!meter.bytes()) GTEST_SKIP() << "this system does not let a process reset its peak memory";
    {
        const std::vector<char> much(size, 'x');
        EXPECT_EQ(much[size / 2], 'x');
    }
    // The kernel's counts lag by some pages.
    EXPECT_GE(*meter.bytes(), static_cast<std::int64_t>(size - size / 64));
    EXPECT_LT(*meter.bytes(), static_cast<std::int64_t>(2 * size));
    const PeakMemory again;
    EXPECT_LT(*again.bytes(), static_cast<std::int64_t>(size / 4));
}

TEST(Diagram, WritesDataAndScriptWhateverDraws) {
    const test::TemporaryFolder folder;
    Results results = measured(study({run_of("lancet it's", 1, 2), run_of("eigen", 3, 1)}), {.repetitions = 1});
    const std::string complaint = draw(results.rows, Shown::judged, "a 'title'", folder.path() / "plots", "picture");
    const std::string data = test::read_text(folder.path() / "plots" / "picture.dat");
    EXPECT_THAT(data, testing::HasSubstr("# Pareto front"));
    EXPECT_THAT(test::read_text(folder.path() / "plots" / "picture.gp"), testing::HasSubstr("set logscale xy"));
    if (!complaint.empty()) GTEST_SKIP() << "no pictures: " << complaint;
    EXPECT_THAT(test::read_text(folder.path() / "plots" / "picture.svg"), testing::HasSubstr("</svg>"));
    EXPECT_THAT(test::read_text(folder.path() / "plots" / "picture.png"), testing::HasSubstr("PNG"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path() / "plots"), {}), 4);
}

}  // namespace
}  // namespace lancet::experiments::precision
