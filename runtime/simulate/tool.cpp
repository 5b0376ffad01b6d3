#include "lancet/runtime/simulate/tool.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/atomic_file.hpp"
#include "lancet/mesh/io/cursor.hpp"

namespace lancet::runtime {

namespace {

std::string read_text(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string text;
    if (in && !std::filesystem::is_directory(file)) {
        text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    if (!in || std::filesystem::is_directory(file)) throw Error(file.string() + ": cannot be read as a tool path");
    return text;
}

}  // namespace

std::string_view to_string(ToolAction action) noexcept {
    switch (action) {
        case ToolAction::grab:
            return "grab";
        case ToolAction::cut:
            return "cut";
        case ToolAction::idle:
            return "idle";
        default:
            return "touch";
    }
}

ToolAction tool_action_from_string(std::string_view text) {
    for (const ToolAction action : {ToolAction::touch, ToolAction::grab, ToolAction::cut, ToolAction::idle}) {
        if (text == to_string(action)) return action;
    }
    throw Error("tool: unknown action '" + std::string(text) + "'; expected touch, grab, cut or idle");
}

void require_valid(std::span<const ToolSample> path) {
    for (std::size_t k = 0; k < path.size(); ++k) {
        const auto fail = [&](const std::string& what) {
            throw Error("tool path: sample " + std::to_string(k) + what);
        };
        const ToolSample& sample = path[k];
        if (!std::isfinite(sample.time)) fail(": its time is not finite");
        try {
            validate(sample.pose);
        } catch (const Error& error) {
            fail(std::string(": ") + error.what());
        }
        if (k > 0 && sample.time < path[k - 1].time) {
            fail(" is at " + std::to_string(sample.time) + " s, before the one at " + std::to_string(path[k - 1].time));
        }
    }
}

ToolPath resampled(std::span<const ToolSample> path, double interval) {
    if (!(interval > 0) || !std::isfinite(interval)) {
        throw Error("tool path: an interval of " + std::to_string(interval) + " s; expected a positive one");
    }
    require_valid(path);
    ToolPath dense;
    if (path.empty()) return dense;
    std::size_t before = 0;
    for (std::int64_t k = 0;; ++k) {
        const double time = path.front().time + static_cast<double>(k) * interval;
        if (time >= path.back().time) break;
        while (before + 1 < path.size() && path[before + 1].time <= time) ++before;
        const ToolSample& from = path[before];
        const ToolSample& to = path[before + 1];
        dense.push_back(
            {time, interpolate(from.pose, to.pose, (time - from.time) / (to.time - from.time)), from.action, 0});
    }
    dense.push_back(path.back());
    return dense;
}

ToolPath read_tool_path(const std::filesystem::path& file) {
    const std::string text = read_text(file), name = file.string();
    mesh::io::Cursor lines(text, name);
    ToolPath path;
    while (lines.remaining() > 0) {
        const std::size_t begin = lines.position();
        const std::string_view line = lines.line();
        mesh::io::Cursor words = lines.part(begin, begin + std::min(line.size(), line.find('#')));
        if (words.at_end()) continue;
        ToolSample sample;
        sample.time = words.number("a time in seconds");
        for (double& value : sample.pose.position) value = words.number("a position of three numbers");
        for (double& value : sample.pose.orientation) value = words.number("a quaternion of four numbers");
        const std::string_view action = words.word("an action: touch, grab, cut or idle");
        try {
            sample.action = tool_action_from_string(action);
            if (!words.at_end()) throw Error("the end of the line expected after the action");
            path.push_back(sample);
            require_valid(std::span(path).last(std::min<std::size_t>(2, path.size())));
        } catch (const Error& error) {
            words.fail(error.what());
        }
    }
    if (path.empty()) throw Error(name + ": no sample; expected lines of \"time x y z w x y z action\"");
    return path;
}

void write_tool_path(const std::filesystem::path& file, std::span<const ToolSample> path) {
    require_valid(path);
    mesh::io::AtomicFile out(file);
    out << "# time [s]  position x y z [m]  orientation w x y z  action\n";
    for (const ToolSample& sample : path) {
        out.number(sample.time);
        for (const double value : sample.pose.position) (out << " ").number(value);
        for (const double value : sample.pose.orientation) (out << " ").number(value);
        out << " " << to_string(sample.action) << "\n";
    }
    out.commit();
}

}  // namespace lancet::runtime
