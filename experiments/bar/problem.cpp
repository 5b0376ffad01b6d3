#include "lancet/experiments/bar/problem.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>
#include <system_error>

#include <CLI/CLI.hpp>

#include "lancet/experiments/common/table.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/io/read.hpp"

namespace lancet::experiments::bar {
namespace {

template <class Number>
bool parse_number(std::string_view text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

/// Whether `text` is exactly `count` comma-separated numbers.
template <class Number, std::size_t count>
bool parse_list(std::string_view text, std::array<Number, count>& numbers) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t comma = text.find(',');
        const bool last = i + 1 == count;
        if (last != (comma == std::string_view::npos)) return false;
        if (!parse_number(text.substr(0, comma), numbers[i])) return false;
        text.remove_prefix(last ? text.size() : comma + 1);
    }
    return true;
}

template <class Number, std::size_t count>
void add_list(CLI::App& app, const std::string& option, std::array<Number, count>& target, const std::string& what) {
    app.add_option_function<std::string>(
           option,
           [option, &target](const std::string& text) {
               if (!parse_list(text, target)) {
                   throw Error(option + ": '" + text + "' found, expected " + std::to_string(count) +
                               (std::is_integral_v<Number> ? " whole numbers" : " numbers") + " separated by commas");
               }
           },
           what)
        ->type_name("LIST");
}

template <class Number, std::size_t count>
std::string join(const std::array<Number, count>& numbers) {
    std::string text;
    for (const Number number : numbers) text += (text.empty() ? "" : ",") + format_exact(static_cast<double>(number));
    return text;
}

void check(bool holds, const std::string& option, const std::string& found, const std::string& expected) {
    if (!holds) throw Error(option + ": " + found + " found, expected " + expected);
}

void check_positive(const std::string& option, double value) {
    check(std::isfinite(value) && value > 0, option, format_exact(value), "a positive number");
}

void check_options(const ProblemOptions& options) {
    if (options.mesh.empty()) {
        for (const int cells : options.cells) {
            check(cells >= 1, "--cells", std::to_string(cells), "at least 1 cell along each axis");
        }
        for (const double size : options.size) check_positive("--size", size);
        check(options.split == 5 || options.split == 6, "--split", std::to_string(options.split), "5 or 6");
    } else {
        check_positive("--mesh-scale", options.mesh_scale);
    }
    check_positive("--young", options.young_modulus);
    check(options.poisson_ratio > -1 && options.poisson_ratio < 0.5, "--poisson", format_exact(options.poisson_ratio),
          "a number above -1 and below 0.5");
    check_positive("--density", options.density);
    for (const double factor : options.rayleigh) {
        check(std::isfinite(factor) && factor >= 0, "--rayleigh", format_exact(factor),
              "numbers that are not negative");
    }
    for (const double component : options.gravity) {
        check(std::isfinite(component), "--gravity", format_exact(component), "finite numbers");
    }
    check_positive("--time-step", options.time_step);
    check(options.steps >= 1, "--steps", std::to_string(options.steps), "at least 1");
}

mesh::TetMesh make_mesh(const ProblemOptions& options, std::vector<std::string>& notes) {
    if (options.mesh.empty()) {
        mesh::Box box;
        box.cells = options.cells;
        box.size = options.size;
        box.split = options.split == 5 ? mesh::Split::five : mesh::Split::six;
        return mesh::box(box);
    }
    mesh::ReadOptions read_options;
    read_options.scale = options.mesh_scale;
    mesh::ReadResult result = mesh::read(options.mesh, read_options);
    notes = std::move(result.notes);
    return std::move(result.mesh);
}

std::size_t longest_axis(const std::array<mesh::Point, 2>& bounds) {
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis) {
        if (bounds[1][axis] - bounds[0][axis] > bounds[1][longest] - bounds[0][longest]) longest = axis;
    }
    return longest;
}

std::vector<std::int32_t> nodes_where(const mesh::TetMesh& mesh,
                                      const std::function<bool(const mesh::Point&)>& condition) {
    std::vector<std::int32_t> found;
    for (std::size_t node = 0; node < mesh.nodes().size(); ++node) {
        if (condition(mesh.nodes()[node])) found.push_back(static_cast<std::int32_t>(node));
    }
    return found;
}

std::vector<std::int32_t> nodes_in_box(const mesh::TetMesh& mesh, const std::array<double, 6>& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        check(std::isfinite(box[axis]) && std::isfinite(box[axis + 3]) && box[axis] <= box[axis + 3], "--fix",
              format_exact(box[axis]) + " to " + format_exact(box[axis + 3]),
              "xmin,ymin,zmin,xmax,ymax,zmax with min <= max");
    }
    return nodes_where(mesh, [&box](const mesh::Point& point) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (point[axis] < box[axis] || point[axis] > box[axis + 3]) return false;
        }
        return true;
    });
}

std::vector<std::int32_t> nodes_at_low_end(const mesh::TetMesh& mesh, double fraction) {
    const auto bounds = mesh.bounds();
    const std::size_t axis = longest_axis(bounds);
    const double limit = bounds[0][axis] + fraction * (bounds[1][axis] - bounds[0][axis]);
    return nodes_where(mesh, [axis, limit](const mesh::Point& point) { return point[axis] <= limit; });
}

std::string list_node_sets(const mesh::TetMesh& mesh) {
    std::string text;
    for (const auto& [name, nodes] : mesh.node_sets()) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
}

}  // namespace

void add_problem_options(CLI::App& app, ProblemOptions& options) {
    const std::string group = "Problem";
    app.option_defaults()->group(group);
    add_list(app, "--cells", options.cells, "Cells of the box along x, y, z");
    add_list(app, "--size", options.size, "Size of the box along x, y, z in m");
    app.add_option("--split", options.split, "Tetrahedra per cell: 5 or 6");
    app.add_option("--mesh", options.mesh, "Read the mesh from FILE instead of meshing a box")->type_name("FILE");
    app.add_option("--mesh-scale", options.mesh_scale, "Factor on the coordinates of the mesh, to get metres");
    app.add_option("--fix", options.fix,
                   "Fixed nodes: a box xmin,ymin,zmin,xmax,ymax,zmax after scaling, the name of a node set, or auto: "
                   "the face x = 0 of the box, the lowest 5 % of the longest axis of another mesh")
        ->type_name("BOX|SET");
    auto* young = app.add_option("--young", options.young_modulus, "Young's modulus in Pa");
    auto* poisson = app.add_option("--poisson", options.poisson_ratio, "Poisson's ratio");
    auto* density = app.add_option("--density", options.density, "Density in kg/m^3");
    app.add_option_function<std::string>(
           "--material",
           [&options](const std::string& text) {
               std::array<double, 3> values{};
               if (!parse_list(text, values)) throw Error("--material: '" + text + "' found, expected E,NU,RHO");
               options.young_modulus = values[0];
               options.poisson_ratio = values[1];
               options.density = values[2];
           },
           "Young's modulus, Poisson's ratio and density at once")
        ->type_name("E,NU,RHO")
        ->excludes(young)
        ->excludes(poisson)
        ->excludes(density);
    add_list(app, "--rayleigh", options.rayleigh, "Damping ALPHA,BETA: D = ALPHA M + BETA K (1/s and s)");
    add_list(app, "--gravity", options.gravity, "Gravity x,y,z in m/s^2");
    app.add_option("--time-step", options.time_step, "Time step in s");
    app.add_option("--steps", options.steps, "Number of time steps");
    app.option_defaults()->group("Options");
}

std::vector<std::string> problem_arguments(const ProblemOptions& options) {
    std::vector<std::string> arguments;
    const auto add = [&arguments](const std::string& option, const std::string& value) {
        arguments.push_back(option + "=" + value);  // one word: a value may begin with a minus sign
    };
    if (options.mesh.empty()) {
        add("--cells", join(options.cells));
        add("--size", join(options.size));
        add("--split", std::to_string(options.split));
    } else {
        add("--mesh", options.mesh);
        add("--mesh-scale", format_exact(options.mesh_scale));
    }
    add("--fix", options.fix);
    add("--young", format_exact(options.young_modulus));
    add("--poisson", format_exact(options.poisson_ratio));
    add("--density", format_exact(options.density));
    add("--rayleigh", join(options.rayleigh));
    add("--gravity", join(options.gravity));
    add("--time-step", format_exact(options.time_step));
    add("--steps", std::to_string(options.steps));
    return arguments;
}

std::vector<std::int32_t> fixed_nodes(const mesh::TetMesh& mesh, const std::string& fix) {
    std::vector<std::int32_t> fixed;
    std::array<double, 6> box{};
    if (fix == "auto") {
        fixed = nodes_at_low_end(mesh, 0.05);
    } else if (parse_list(fix, box)) {
        fixed = nodes_in_box(mesh, box);
    } else {
        const auto set = mesh.node_sets().find(fix);
        if (set == mesh.node_sets().end()) {
            throw Error("--fix: '" + fix +
                        "' found, expected auto, six numbers separated by commas, or a node set of " +
                        "the mesh (it has: " + list_node_sets(mesh) + ")");
        }
        fixed = set->second;
        std::sort(fixed.begin(), fixed.end());
    }
    const auto bounds = mesh.bounds();
    if (fixed.empty()) {
        throw Error("--fix: no node lies in '" + fix + "', expected at least one; the mesh reaches from " +
                    join(bounds[0]) + " to " + join(bounds[1]));
    }
    if (fixed.size() == mesh.nodes().size()) {
        throw Error("--fix: '" + fix + "' holds all " + std::to_string(fixed.size()) + " nodes, expected some to move");
    }
    return fixed;
}

Problem make_problem(const ProblemOptions& options) {
    check_options(options);
    Problem problem;
    problem.mesh = make_mesh(options, problem.notes);
    problem.young_modulus = options.young_modulus;
    problem.poisson_ratio = options.poisson_ratio;
    problem.density = options.density;
    problem.rayleigh_mass = options.rayleigh[0];
    problem.rayleigh_stiffness = options.rayleigh[1];
    problem.gravity = options.gravity;
    const bool end_face = options.mesh.empty() && options.fix == "auto";
    problem.fixed_nodes = fixed_nodes(problem.mesh, end_face ? "x_min" : options.fix);
    problem.time_step = options.time_step;
    problem.steps = options.steps;
    const auto bounds = problem.mesh.bounds();
    const std::size_t axis = longest_axis(bounds);
    problem.length = bounds[1][axis] - bounds[0][axis];
    return problem;
}

}  // namespace lancet::experiments::bar
