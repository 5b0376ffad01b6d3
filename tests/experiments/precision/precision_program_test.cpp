// The program `precision` from its command line to its files.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/process.hpp"

namespace lancet::experiments::precision {
namespace {

int run(const std::string& program, const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result = run_process({.program = program, .arguments = arguments});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(PrecisionProgram, MeasuresEverythingQuickly) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json";
    const auto csv_file = folder.path() / "out.csv";
    std::string output;
    ASSERT_EQ(run(LANCET_PRECISION_PROGRAM,
                  {"--quick", "--json", json_file.string(), "--csv", csv_file.string(), "--plot",
                   (folder.path() / "plots").string()},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("For an error of so much use"));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("problem,variant,method,"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "plots" / "bar-static-1-m.gp"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    EXPECT_TRUE(json.at("omissions").is_array());

    std::set<std::string> problems, methods, integrators, scalars;
    std::set<std::string> with_front;
    for (const auto& row : json.at("rows")) {
        const std::string problem = row.at("problem");
        problems.insert(problem);
        methods.insert(row.at("method"));
        scalars.insert(row.at("scalar"));
        if (row.at("integrator").is_string()) integrators.insert(row.at("integrator"));
        if (row.at("pareto").get<bool>()) with_front.insert(problem);
        EXPECT_GT(row.at("seconds").get<double>(), 0);
        EXPECT_GT(row.at("elements").get<int>(), 0);
        EXPECT_GE(row.at("error_l2").get<double>(), 0);
        EXPECT_GE(row.at("error_energy").get<double>(), 0);
        EXPECT_GE(row.at("error_qoi").get<double>(), 0);
    }
    const std::set<std::string> all{"bar-static", "bar-dynamic", "cantilever", "beam", "tumbling"};
    EXPECT_EQ(problems, all);
    EXPECT_EQ(with_front, all);
    EXPECT_EQ(methods, (std::set<std::string>{"lancet", "lancet-extrapolated", "eigen"}));
    EXPECT_EQ(scalars, (std::set<std::string>{"float", "mixed", "double"}));
    EXPECT_EQ(integrators, (std::set<std::string>{"implicit-euler", "implicit-midpoint", "newmark", "symplectic-euler",
                                                  "central-differences"}));

    // Extrapolated from small meshes, the published displacements are met.
    ASSERT_GE(json.at("published").size(), 5u);
    for (const auto& value : json.at("published")) {
        EXPECT_LT(value.at("difference_percent").get<double>(), 3) << value;
    }
    ASSERT_GE(json.at("budget").size(), 7u);
    for (const auto& line : json.at("budget")) EXPECT_NE(line.at("dominates"), "nothing") << line;
    EXPECT_EQ(json.at("advice").size() % 4, 0u);
    EXPECT_GE(json.at("advice").size(), 28u);
}

/// Two codes that share the mesh and nothing else come to the same discrete solution.
TEST(PrecisionProgram, AgreesWithItsBaseline) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json";
    ASSERT_EQ(run(LANCET_PRECISION_PROGRAM,
                  {"--quick", "--problem=bar-static,beam", "--scalar=double", "--json", json_file.string()}),
              0);
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    int compared = 0;
    for (const auto& ours : json.at("rows")) {
        if (ours.at("method") != "lancet" || ours.at("tolerance").get<double>() > 1e-5) continue;
        for (const auto& theirs : json.at("rows")) {
            if (theirs.at("method") != "eigen" || theirs.at("problem") != ours.at("problem") ||
                theirs.at("variant") != ours.at("variant") || theirs.at("cells") != ours.at("cells")) {
                continue;
            }
            const double value = ours.at("qoi").get<double>();
            EXPECT_NEAR(theirs.at("qoi").get<double>(), value, 1e-3 * std::abs(value)) << theirs;
            ++compared;
        }
    }
    EXPECT_GE(compared, 12);
}

TEST(PrecisionProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run(LANCET_PRECISION_PROGRAM, {"--help"}), 0);
    for (const std::string bad :
         {"--problem=organ", "--problem=", "--threads=0", "--threads=1,x", "--scalar=half", "--isa=mmx",
          "--scheduler=cron", "--repetitions=0", "--limit=-1", "--json=/nowhere/out.json", "--unknown"}) {
        EXPECT_EQ(run(LANCET_PRECISION_PROGRAM, {bad}), 2) << bad;
    }
    EXPECT_EQ(run(LANCET_PRECISION_PROGRAM, {"--scheduler=serial", "--threads=2"}), 2);
    EXPECT_EQ(run(LANCET_PRECISION_EIGEN, {"--help"}), 0);
    for (const std::string bad : {"--preconditioner=magic", "--tolerance=2", "--scalar=mixed", "--model=rubber"}) {
        EXPECT_EQ(run(LANCET_PRECISION_EIGEN, {bad}), 2) << bad;
    }
}

}  // namespace
}  // namespace lancet::experiments::precision
