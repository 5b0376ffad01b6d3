#include "lancet/experiments/cutting/shape.hpp"

namespace lancet::experiments::cutting {

Shape take_shape(int step, const runtime::CuttableBody& body) {
    std::vector<mesh::Point> positions(body.body().nodes());
    body.body().positions(positions);
    Shape shape{
        .step = step, .time = body.body().time(), .points = {}, .geometry = part_geometry(body.mesh(), body.blend())};
    shape.points = place(shape.geometry, body.mesh(), positions);
    return shape;
}

}  // namespace lancet::experiments::cutting
