#include "lancet/experiments/precision/words.hpp"

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::precision {

kernels::RotationMethod rotation_method(const std::string& name) {
    using kernels::RotationMethod;
    for (const RotationMethod method :
         {RotationMethod::quaternion, RotationMethod::polar, RotationMethod::svd, RotationMethod::robust}) {
        if (kernels::to_string(method) == name) return method;
    }
    throw Error("unknown rotation method '" + name + "'; expected quaternion, polar, svd or robust");
}

std::size_t elements_of(const std::array<int, 3>& cells) {
    return 5 * static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
           static_cast<std::size_t>(cells[2]);
}

BoxField displacement_field(const mesh::Box& box, std::span<const Point> positions) {
    const mesh::TetMesh mesh = mesh::box(box);
    std::vector<Point> displacement(positions.begin(), positions.end());
    if (displacement.size() != mesh.nodes().size()) {
        throw Error(std::to_string(displacement.size()) + " positions found, expected " +
                    std::to_string(mesh.nodes().size()));
    }
    for (std::size_t node = 0; node < displacement.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) displacement[node][axis] -= mesh.nodes()[node][axis];
    }
    return {box, displacement};
}

std::vector<Point> points_of(std::span<const double> numbers) {
    std::vector<Point> points;
    points.reserve(numbers.size() / 3);
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
        points.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    return points;
}

std::string family(const Setting& setting) {
    Setting any = setting;
    any.cells = {0, 0, 0};
    return any.label();
}

}  // namespace lancet::experiments::precision
