// The program `collision` from its command line to its files.

#include <fstream>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/process.hpp"

namespace lancet::experiments::collision {
namespace {

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result =
        run_process({.program = LANCET_COLLISION_PROGRAM, .arguments = arguments, .environment = {}, .timeout = {}});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(CollisionProgram, ComparesAllKindsInAllScenes) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", csv_file = folder.path() / "out.csv";
    std::string output;
    ASSERT_EQ(run({"--primitives=1000", "--steps=4", "--repetitions=2", "--json", json_file.string(), "--csv",
                   csv_file.string()},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("found the same pairs and contacts"));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("scene,primitives,queries,kind,ms_build,"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    std::map<std::string, std::set<std::string>> kinds;
    for (const auto& row : json.at("rows")) {
        kinds[row.at("scene")].insert(row.at("kind"));
        for (const std::string key : {"ms_build", "ms_refit", "ms_query", "ms_contacts", "megabytes"}) {
            EXPECT_GE(row.at(key).get<double>(), 0) << row;
        }
        EXPECT_GT(row.at("primitives").get<int>(), 0);
        EXPECT_GT(row.at("contacts").get<int>(), 0) << row;
        EXPECT_GE(row.at("candidates").get<int>(), row.at("contacts").get<int>()) << row;
    }
    const std::set<std::string> all{"aabb-tree", "sphere-tree", "spatial-hash", "octree", "brute-force"};
    for (const std::string scene : {"organ", "bodies", "folded"}) EXPECT_EQ(kinds[scene], all) << scene;
}

TEST(CollisionProgram, RunsOnThreads) {
    std::string output;
    EXPECT_EQ(run({"--primitives=1000", "--steps=2", "--repetitions=1", "--scene=bodies", "--kind=octree,spatial-hash",
                   "--threads=2"},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("spatial-hash"));
    EXPECT_THAT(output, testing::Not(testing::HasSubstr("aabb-tree")));
}

TEST(CollisionProgram, RefusesWhatMakesNoSense) {
    std::string output;
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--kind=bsp"},
                                                      {"--scene=cloth"},
                                                      {"--primitives=1"},
                                                      {"--scalar=float"},
                                                      {"--isa=avx2"},
                                                      {"--threads=2", "--scheduler=serial"},
                                                      {"--steps=0"}}) {
        EXPECT_EQ(run(arguments, &output), 2) << arguments.front();
    }
}

}  // namespace
}  // namespace lancet::experiments::collision
