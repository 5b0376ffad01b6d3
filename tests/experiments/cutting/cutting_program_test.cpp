// The program `cutting` from its command line to its files.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/process.hpp"
#include "lancet/mesh/generate/cylinder.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace lancet::experiments::cutting {
namespace {

int run_as(Command command, std::string* output = nullptr) {
    command.program = LANCET_CUTTING_PROGRAM;
    const ProcessResult result = run_process(command);
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    return run_as({.arguments = arguments}, output);
}

const std::vector<std::string> asked_for{"scene",        "enrichment",     "operator",      "scalar",      "elements",
                                         "cut_elements", "added_dofs",     "ms_geometry",   "ms_topology", "ms_update",
                                         "ms_step",      "cut_lane_ratio", "cg_iterations", "error_l2"};

TEST(CuttingProgram, MeasuresEverySceneQuickly) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", csv_file = folder.path() / "out.csv";
    const auto frames = folder.path() / "frames", plots = folder.path() / "plots";
    std::string output;
    ASSERT_EQ(run({"--quick", "--levels=1", "--json", json_file.string(), "--csv", csv_file.string(), "--pvd",
                   frames.string(), "--plot", plots.string()},
                  &output),
              0);
    for (const std::string title : {"Cut elements:", "Dissected beam:", "Organ:", "Scalpel:", "Cost:",
                                    "Beam cut, case 1", "Beam cut, case 2T", "Beam cut, case 3T"}) {
        EXPECT_THAT(output, testing::HasSubstr(title));
    }
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("scene,variant,model,enrichment,operator,scalar,"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    for (const auto& ratio : json.at("lane_ratios")) EXPECT_GT(ratio.at("cut_lane_ratio").get<double>(), 0) << ratio;

    std::set<std::string> scenes;
    std::int64_t scalpel_frames = 0, last_cut = 0;
    std::vector<std::int64_t> cost_cuts;
    for (const auto& row : json.at("rows")) {
        for (const std::string& key : asked_for) EXPECT_TRUE(row.contains(key)) << key << " is not in " << row;
        const std::string scene = row.at("scene");
        scenes.insert(scene);
        EXPECT_EQ(row.at("enrichment"), "substituted");
        EXPECT_GT(row.at("elements").get<int>(), 0);
        EXPECT_TRUE(std::isfinite(row.at("error_l2").get<double>())) << row;
        const bool is_static = scene.starts_with("beam-case") || scene == "fraction-floor";
        EXPECT_LT(row.at("error_l2").get<double>(), is_static ? 0.4 : 0.05) << row;
        if (is_static) continue;
        EXPECT_GT(row.at("ms_step").get<double>(), 0) << row;
        EXPECT_GT(row.at("cut_lane_ratio").get<double>(), 0) << row;
        const std::int64_t cut = row.at("cut_elements");
        if (scene == "cost" && row.at("scalar") == "float") cost_cuts.push_back(cut);
        if (scene != "scalpel" || row.at("frame").is_null() || row.at("scalar") != "float" ||
            row.at("variant") != "cut") {
            continue;
        }
        ++scalpel_frames;
        EXPECT_GE(cut, last_cut);
        last_cut = cut;
    }
    EXPECT_EQ(scenes, (std::set<std::string>{"dissected-beam", "organ", "scalpel", "cost", "beam-case1", "beam-case2T",
                                             "beam-case3T", "fraction-floor"}));
    EXPECT_GT(scalpel_frames, 10);
    EXPECT_GT(last_cut, 50);
    ASSERT_EQ(cost_cuts.size(), 6U);
    EXPECT_TRUE(std::ranges::is_sorted(cost_cuts, std::ranges::less_equal())) << "of 0, 1, 2, 5, 10, 30 %";
    EXPECT_EQ(cost_cuts.back(), 480);  // 30 % of 1600

    for (const std::string name : {"dissected-beam", "organ", "scalpel"}) {
        const std::string index = test::read_text(frames / (name + ".pvd"));
        EXPECT_THAT(index, testing::HasSubstr(name + "/0.vtu"));
        std::size_t written = 0;
        for (const auto& entry : std::filesystem::directory_iterator(frames / name)) {
            ++written;
            EXPECT_EQ(entry.path().extension(), ".vtu");
            EXPECT_THAT(index, testing::HasSubstr(name + "/" + entry.path().filename().string()));
        }
        EXPECT_GE(written, 11U);
        EXPECT_THAT(test::read_text(frames / name / "10.vtu"), testing::HasSubstr("Name=\"surface\""));
        EXPECT_TRUE(std::filesystem::exists(plots / (name + ".gp")));
    }
}

TEST(CuttingProgram, WithoutGnuplotTheNumbersAreThereAllTheSame) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", plots = folder.path() / "plots";
    ASSERT_EQ(run_as({.arguments = {"--quick", "--scene=dissected-beam", "--scalar=float", "--json", json_file.string(),
                                    "--plot", plots.string()},
                      .environment = {{"PATH", folder.path().string()}}}),
              0);
    EXPECT_EQ(nlohmann::json::parse(std::ifstream(json_file)).at("rows").size(), 3U);
    EXPECT_TRUE(std::filesystem::exists(plots / "dissected-beam.gp"));
    EXPECT_FALSE(std::filesystem::exists(plots / "dissected-beam.png"));
}

TEST(CuttingProgram, TakesAnOrganFromAFile) {
    const test::TemporaryFolder folder;
    const auto mesh_file = folder.path() / "rod.vtu", json_file = folder.path() / "out.json";
    const mesh::TetMesh rod = mesh::cylinder({.length = 40, .radius = 6, .cells_along = 10, .cells_across = 2});
    mesh::write_vtu(mesh_file, rod);
    std::string output;
    ASSERT_EQ(run({"--quick", "--scene=organ", "--scalar=double", "--operator=matrix-free", "--mesh",
                   mesh_file.string(), "--json", json_file.string()},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("rod.vtu"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    ASSERT_EQ(json.at("rows").size(), 3U);
    const auto& cut = json.at("rows")[1];
    EXPECT_EQ(cut.at("elements"), rod.tetrahedra().size());
    EXPECT_EQ(cut.at("operator"), "matrix-free");
    EXPECT_EQ(cut.at("scalar"), "double");
    EXPECT_GT(cut.at("cut_elements").get<int>(), 0);
    EXPECT_GT(cut.at("added_dofs").get<int>(), 0);
}

// Halving the cells must bring both errors down, with the cut along faces and through elements. A front that is off by
// a part of a cell costs what a mesh coarser by that much does.
TEST(CuttingProgram, TheBeamCutConverges) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json";
    ASSERT_EQ(run({"--scene=beam-case1", "--levels=2", "--json", json_file.string()}), 0);
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    ASSERT_EQ(json.at("rows").size(), 2U * 6 * 2);
    double aligned = 0;
    for (const auto& row : json.at("rows")) {
        if (row.at("order_l2").is_null()) continue;
        EXPECT_GT(row.at("order_l2").get<double>(), 0.9) << row;
        EXPECT_GT(row.at("order_energy").get<double>(), 0.9) << row;
        const auto error = row.at("error_l2").get<double>();
        if (row.at("variant") == "aligned") aligned = error;
        EXPECT_LT(error, 1.5 * aligned) << row;
    }
}

TEST(CuttingProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run({"--help"}), 0);
    for (const std::string bad : {"--scene=liver", "--scene=", "--threads=0", "--threads=1,2", "--scalar=half",
                                  "--isa=mmx", "--scheduler=cron", "--repetitions=0", "--levels=0", "--levels=x",
                                  "--operator=dense", "--mesh-scale=2", "--json=/nowhere/out.json", "--unknown"}) {
        EXPECT_EQ(run({bad}), 2) << bad;
    }
    EXPECT_EQ(run({"--scheduler=serial", "--threads=2"}), 2);
    EXPECT_EQ(run({"--quick", "--scene=organ", "--mesh=/nowhere/organ.msh"}), 2);
}

}  // namespace
}  // namespace lancet::experiments::cutting
