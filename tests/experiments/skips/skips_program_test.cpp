// The program `skips` from its command line to its files.

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/process.hpp"

namespace lancet::experiments::skips {
namespace {

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result = run_process({.program = LANCET_SKIPS_PROGRAM, .arguments = arguments});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(SkipsProgram, MeasuresEveryItem) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", csv_file = folder.path() / "out.csv";
    std::string output;
    ASSERT_EQ(run({"--quick", "--repetitions=1", "--json", json_file.string(), "--csv", csv_file.string()}, &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("no cut: no enrichment"));
    EXPECT_THAT(output, testing::HasSubstr("not there"));
    EXPECT_THAT(test::read_text(csv_file),
                testing::StartsWith("item,switch,scene,unit,ms_with,ms_without,time_ratio,"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("load_average"));
    ASSERT_EQ(json.at("rows").size(), 15U);
    for (const auto& row : json.at("rows")) {
        EXPECT_GT(row.at("ms_with").get<double>(), 0) << row;
        EXPECT_GT(row.at("ms_without").get<double>(), 0) << row;
        EXPECT_GT(row.at("time_ratio").get<double>(), 0) << row;
        EXPECT_EQ(row.at("proof") == "same bits", row.at("error_percent") == 0.0) << row;
    }
    EXPECT_FALSE(json.at("remarks").empty());
}

TEST(SkipsProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run({"--help"}), 0);
    for (const std::string bad :
         {"--repetitions=0", "--threads=2", "--scalar=double", "--scheduler=tbb", "--isa=sse2", "--unknown"}) {
        EXPECT_EQ(run({bad}), 2) << bad;
    }
}

}  // namespace
}  // namespace lancet::experiments::skips
