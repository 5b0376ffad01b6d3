#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "lancet/runtime/collide/tool_shape.hpp"

namespace lancet::runtime {

/// What the hand does.
enum class ToolAction {
    touch,  ///< the tool pushes what it meets
    grab,   ///< it holds on to what it has met when this began
    cut,    ///< its blade cuts; nothing else of it is felt
    idle    ///< it goes through everything, as when it is drawn out of a wound
};
/// "touch", "grab", "cut" or "idle".
std::string_view to_string(ToolAction action) noexcept;
/// The inverse. Throws lancet::Error, which lists the choices, for another text.
ToolAction tool_action_from_string(std::string_view text);

/// Where a tool is at some time, and what it does.
struct ToolSample {
    double time = 0;  ///< s, of the simulation
    Pose pose{};
    ToolAction action = ToolAction::touch;
    double stamp = 0;  ///< of steady_seconds(), when the hand was there; 0 where no hand was. Not written to files

    friend bool operator==(const ToolSample&, const ToolSample&) = default;
};

/// How a tool was moved: samples by time.
using ToolPath = std::vector<ToolSample>;

/// The path with a sample every `interval` seconds from the first on, the last one included: poses in between, actions
/// as of the sample before. Throws lancet::Error for an interval that is not positive, or a path that `require_valid`
/// refuses.
ToolPath resampled(std::span<const ToolSample> path, double interval);

/// Throws lancet::Error, which names the sample, for numbers that are not finite, quaternions that are not of unit
/// length (up to 1e-6), and times that do not grow.
void require_valid(std::span<const ToolSample> path);

/// Reads a path: a line for each sample, "time x y z w x y z action", in metres and seconds; what follows # is a
/// comment. Throws lancet::Error with file, line and what was expected.
ToolPath read_tool_path(const std::filesystem::path& file);
/// Writes what read_tool_path reads back to the same numbers; the file appears by rename.
void write_tool_path(const std::filesystem::path& file, std::span<const ToolSample> path);

}  // namespace lancet::runtime
