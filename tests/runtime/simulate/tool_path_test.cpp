#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/simulate/tool.hpp"

namespace lancet::runtime {
namespace {

std::filesystem::path file_of(const std::string& text) {
    const auto file = std::filesystem::path(testing::TempDir()) / "lancet_tool_path.txt";
    std::ofstream(file) << text;
    return file;
}

TEST(ToolPath, IsReadBackToTheBit) {
    const double half = std::numbers::sqrt2 / 2;
    const ToolPath path{{.time = 0.1, .pose = {.position = {1.0 / 3, -2e-17, 5}}},
                        {.time = 0.1, .pose = {.orientation = {half, 0, half, 0}}, .action = ToolAction::grab},
                        {.time = 1e3, .pose = {.orientation = {0, 0, 0, -1}}, .action = ToolAction::cut}};
    const auto file = std::filesystem::path(testing::TempDir()) / "lancet_tool_path_written.txt";
    write_tool_path(file, path);
    EXPECT_EQ(read_tool_path(file), path);
}

TEST(ToolPath, KeepsEveryAction) {
    ToolPath path;
    for (const ToolAction action : {ToolAction::touch, ToolAction::grab, ToolAction::cut, ToolAction::idle}) {
        EXPECT_EQ(tool_action_from_string(to_string(action)), action);
        path.push_back({.time = static_cast<double>(path.size()), .action = action});
    }
    const auto file = std::filesystem::path(testing::TempDir()) / "lancet_tool_path_of_actions.txt";
    write_tool_path(file, path);
    EXPECT_EQ(read_tool_path(file), path);
}

TEST(ToolPath, ErrorsNameFileLineAndWhatWasExpected) {
    const auto error_of = [](const std::string& text) {
        try {
            read_tool_path(file_of(text));
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    using testing::AllOf;
    using testing::HasSubstr;
    EXPECT_THAT(error_of("# t\n0 0 0 0 1 0 0 0 touch\n0 0 0 zero 1 0 0 0 cut\n"),
                AllOf(HasSubstr("lancet_tool_path.txt"), HasSubstr("line 3"), HasSubstr("position")));
    EXPECT_THAT(error_of("0 0 0 0 1 0 0 0 stab\n"), AllOf(HasSubstr("line 1"), HasSubstr("touch, grab, cut or idle")));
    EXPECT_THAT(error_of("0 0 0 0 1 0 0 0\n"), AllOf(HasSubstr("line 1"), HasSubstr("action")));
    EXPECT_THAT(error_of("0 0 0 0 1 1 0 0 touch\n"), AllOf(HasSubstr("line 1"), HasSubstr("orientation")));
    EXPECT_THAT(error_of("1 0 0 0 1 0 0 0 touch\n0 0 0 0 1 0 0 0 touch\n"), HasSubstr("line 2"));
    EXPECT_THAT(error_of("0 0 0 0 1 0 0 0 touch 7\n"), HasSubstr("end of the line"));
    EXPECT_THAT(error_of("0 nan 0 0 1 0 0 0 touch\n"), HasSubstr("line 1"));
    EXPECT_THAT(error_of("# nothing\n"), HasSubstr("no sample"));
    EXPECT_THROW(read_tool_path("/no/such/file"), Error);
    EXPECT_THROW(read_tool_path(testing::TempDir()), Error);
}

TEST(ToolPath, IsResampledInBetween) {
    const double half = std::numbers::sqrt2 / 2;
    const ToolPath path{{.time = 0, .action = ToolAction::grab},
                        {.time = 1, .pose = {.position = {1, 2, 3}, .orientation = {half, 0, 0, half}}},
                        {.time = 1.05, .pose = {.position = {0, 0, 0}}}};
    const ToolPath dense = resampled(path, 0.25);
    ASSERT_EQ(dense.size(), 6U);
    EXPECT_DOUBLE_EQ(dense[2].pose.position[1], 1);
    EXPECT_NEAR(dense[2].pose.orientation[0], std::cos(std::numbers::pi / 8), 1e-15);
    EXPECT_EQ(dense[2].action, ToolAction::grab);
    EXPECT_EQ(dense[4].action, ToolAction::touch);
    EXPECT_EQ(dense.back(), path.back());
    EXPECT_THROW(resampled(path, 0), Error);
    EXPECT_TRUE(resampled({}, 1).empty());
}

}  // namespace
}  // namespace lancet::runtime
