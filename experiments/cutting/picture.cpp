#include "lancet/experiments/cutting/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <sstream>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/gnuplot.hpp"
#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::cutting {
namespace {

constexpr int own_colour = 0x8FB3CF, wall_colour = 0xC0392B;

Point seen(const View& view, const Point& point) {
    Point result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t axis = 0; axis < 3; ++axis) result[row] += view.axes[row][axis] * point[axis];
    }
    return result;
}

/// The direction from the body to who looks at it: what gnuplot makes of a view.
Point towards_viewer(const View& view) {
    const double elevation = view.elevation * std::numbers::pi / 180, azimuth = view.azimuth * std::numbers::pi / 180;
    return {std::sin(elevation) * std::sin(azimuth), -std::sin(elevation) * std::cos(azimuth), std::cos(elevation)};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int shaded(int colour, double light) {
    int result = 0;
    for (const int shift : {16, 8, 0}) {
        result |= static_cast<int>(light * ((colour >> shift) & 0xFF)) << shift;
    }
    return result;
}

/// The triangles that face who looks at them. Gnuplot 5.4 sorts and colours quadrangles of two scan lines one by one,
/// which it does not do with polygons: the second scan line of each triangle is its last corner, twice.
void write_data(std::ostream& stream, const Shape& shape, const View& view) {
    const Point viewer = towards_viewer(view);
    const Point sun{0.3, -0.5, 0.81};
    stream.precision(9);
    stream << "# step " << shape.step << "\n# right back up colour\n";
    for (std::size_t t = 0; t < shape.geometry.triangles.size(); ++t) {
        std::array<Point, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = seen(view, shape.points[static_cast<std::size_t>(shape.geometry.triangles[t][k])]);
        }
        Point first{}, second{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            first[axis] = corners[1][axis] - corners[0][axis];
            second[axis] = corners[2][axis] - corners[0][axis];
        }
        const Point normal{first[1] * second[2] - first[2] * second[1], first[2] * second[0] - first[0] * second[2],
                           first[0] * second[1] - first[1] * second[0]};
        const double length = std::sqrt(dot(normal, normal));
        if (dot(normal, viewer) <= 0) continue;
        const int colour = shaded(shape.geometry.is_wall[t] != 0 ? wall_colour : own_colour,
                                  0.6 + 0.4 * std::abs(dot(normal, sun)) / length);
        const auto line = [&](const Point& p) {
            stream << p[0] << ' ' << p[1] << ' ' << p[2] << ' ' << colour << '\n';
        };
        line(corners[0]);
        line(corners[1]);
        stream << '\n';
        line(corners[2]);
        line(corners[2]);
        stream << "\n\n";
    }
}

std::string data_name(const std::string& name, std::size_t shape) {
    return name + "-" + std::to_string(shape) + ".dat";
}

std::string script(std::span<const Shape> shapes, const View& view, const std::string& title, const std::string& name) {
    Point low{}, high{};
    bool is_first = true;
    for (const Shape& shape : shapes) {
        for (const Point& point : shape.points) {
            const Point p = seen(view, point);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = is_first ? p[axis] : std::min(low[axis], p[axis]);
                high[axis] = is_first ? p[axis] : std::max(high[axis], p[axis]);
            }
            is_first = false;
        }
    }
    const std::size_t columns = shapes.size() > 1 ? 2 : 1, rows = (shapes.size() + columns - 1) / columns;
    std::ostringstream text;
    text << "# Draws " << name << ".png: gnuplot " << name << ".gp\n"
         << "if (!exists(\"part\")) part = ''\n"
         << "set terminal pngcairo size " << 800 * columns << ',' << 620 * rows + 60 << " font 'sans,13'\n"
         << "set output " << quoted(name + ".png") << ".part\n"
         << "set multiplot layout " << rows << ',' << columns << " title " << quoted(title) << " noenhanced\n"
         << "unset border\nunset tics\nunset key\nunset colorbox\nset lmargin 0\nset rmargin 0\nset bmargin 0\nset "
            "tmargin 2\n"
         << "set view equal xyz\nset view " << view.elevation << ',' << view.azimuth << ",1.5\n"
         << "set xrange [" << low[0] << ':' << high[0] << "]\nset yrange [" << low[1] << ':' << high[1]
         << "]\nset zrange [" << low[2] << ':' << high[2] << "]\nset xyplane at " << low[2] << '\n'
         << "set pm3d depthorder corners2color c1 border lc '#30506A' lw 0.2\n";
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        text << "set title " << quoted(format_number(shapes[i].time, 3) + " s") << " noenhanced\nsplot "
             << quoted(data_name(name, i)) << " using 1:2:3:4 with pm3d fc rgb variable\n";
    }
    text << "unset multiplot\nunset output\n";
    return text.str();
}

}  // namespace

std::string draw(std::span<const Shape> shapes, const View& view, const std::string& title,
                 const std::filesystem::path& folder, const std::string& name) {
    make_plot_folder(folder);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        write_file(folder / data_name(name, i), [&](std::ostream& stream) { write_data(stream, shapes[i], view); });
    }
    write_file(folder / (name + ".gp"), script(shapes, view, title, name));
    return run_gnuplot(folder, name, std::array<std::string, 1>{".png"});
}

}  // namespace lancet::experiments::cutting
