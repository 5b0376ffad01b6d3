#include "tests/kernels/surface/surfaces.hpp"

#include <cmath>
#include <numbers>

namespace lancet::kernels::test {

Surface rough_torus(int around, int across, double roughness, std::mt19937_64& random) {
    std::uniform_real_distribution<double> coordinate(-1, 1);
    Surface torus;
    const double spacing = 2 * std::numbers::pi / around;
    const auto number = [&](int i, int j) { return (i % around) * across + j % across; };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = spacing * i, v = 2 * std::numbers::pi * j / across;
            const double distance = 1 + 0.3 * std::cos(v);
            Place place{distance * std::cos(u), distance * std::sin(u), 0.3 * std::sin(v)};
            for (double& value : place) value += roughness * spacing * coordinate(random);
            torus.places.push_back(place);
            // Diagonals both ways: vertices have from 4 to 8 triangles.
            const int a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
            if (random() % 2 == 0) {
                torus.triangles.push_back({a, b, c});
                torus.triangles.push_back({a, c, d});
            } else {
                torus.triangles.push_back({a, b, d});
                torus.triangles.push_back({b, c, d});
            }
        }
    }
    return torus;
}

Surface fan(const std::vector<double>& angles) {
    Surface surface{.places = {{0, 0, 0}, {1, 0, 0}}};
    double sum = 0;
    for (const double angle : angles) {
        sum += angle;
        const auto last = static_cast<std::int32_t>(surface.places.size());
        surface.triangles.push_back({0, last - 1, last});
        surface.places.push_back({std::cos(sum), std::sin(sum), 0});
    }
    return surface;
}

}  // namespace lancet::kernels::test
