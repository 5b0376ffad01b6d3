#include "lancet/experiments/scaling/settings.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"

namespace lancet::experiments::scaling {
namespace {

ScalingSettings parse(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv{"scaling"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    return parse_settings(static_cast<int>(argv.size()), argv.data()).value();
}

TEST(ScalingSettings, HaveDefaults) {
    const ScalingSettings settings = parse({});
    EXPECT_EQ(settings.series, series_names());
    EXPECT_EQ(settings.benchmarks, (std::vector<std::string>{"bar", "organ"}));
    EXPECT_EQ(settings.threads.front(), 1);
    EXPECT_TRUE(settings.varies_one_by_one);
    EXPECT_EQ(settings.instruction_sets.front(), kernels::to_string(kernels::active_instruction_set()));
    EXPECT_EQ(settings.scalars.front(), "float");
    EXPECT_EQ(settings.operators.front(), "edge-blocks");
    EXPECT_EQ(settings.scatters.front(), "private-copies");
    EXPECT_GE(settings.steps, 25) << "errors are measured after 25 steps";
    EXPECT_GE(parse({"--quick"}).steps, 25);
    EXPECT_LT(parse({"--quick"}).repetitions, settings.repetitions);
    EXPECT_GT(settings.extra_rounds, 0);
    EXPECT_EQ(parse({"--quick"}).extra_rounds, 0);
    EXPECT_EQ(parse({"--extra-rounds=0"}).extra_rounds, 0);
}

TEST(ScalingSettings, ListsFixTheOthers) {
    const ScalingSettings settings = parse({"--scalar=double,mixed"});
    EXPECT_FALSE(settings.varies_one_by_one);
    EXPECT_EQ(settings.scalars, (std::vector<std::string>{"double", "mixed"}));
    EXPECT_EQ(settings.operators, (std::vector<std::string>{"edge-blocks"}));
    EXPECT_EQ(settings.scatters, (std::vector<std::string>{"private-copies"}));
    EXPECT_EQ(settings.instruction_sets.size(), 1U);
}

TEST(ScalingSettings, ThreadsAscendFromOne) {
    EXPECT_EQ(parse({"--threads=8,2"}).threads, (std::vector<int>{1, 2, 8}));
    EXPECT_EQ(parse({"--threads=1,3"}).threads, (std::vector<int>{1, 3}));
}

TEST(ScalingSettings, TheSerialSchedulerIsNoChoice) {
    EXPECT_TRUE(parse({"--scheduler=serial"}).schedulers.empty());
}

TEST(ScalingSettings, RefuseNonsense) {
    for (const std::string bad :
         {"--series=fast", "--problem=liver", "--operator=dense", "--scatter=luck", "--elements=99", "--elements=x",
          "--setting=best", "--steps=0", "--repetitions=0", "--extra-rounds=-1", "--threads=0", "--threads=2,2",
          "--scalar=half", "--isa=mmx", "--json=/nowhere/x"}) {
        EXPECT_THROW((void)parse({bad}), Error) << bad;
    }
}

}  // namespace
}  // namespace lancet::experiments::scaling
