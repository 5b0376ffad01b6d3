#include "lancet/experiments/common/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <embree3/rtcore.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/collide/vector3.hpp"

namespace lancet::experiments {

using runtime::add_scaled;
using runtime::cross;
using runtime::direction;
using runtime::dot;
using runtime::is_finite;
using runtime::subtract;

namespace {

constexpr Colour sky{0.96, 0.97, 0.98}, ground{0.80, 0.82, 0.85};

/// What a ray has met.
struct Hit {
    double distance = std::numeric_limits<double>::infinity();
    Point normal{};
    Colour colour{};
};

struct Ray {
    Point origin;
    Point direction;  ///< of unit length
};

/// A light over the shoulder, a weaker one from the other side, and as much from everywhere as keeps shadows legible.
Colour shaded(const Hit& hit, const Point& view, const Point& key_light) {
    const Point normal = dot(hit.normal, view) > 0 ? runtime::scale(hit.normal, -1) : hit.normal;
    const double key = std::max(0.0, dot(normal, key_light));
    const double fill = std::max(0.0, -dot(normal, view));
    const Point half = direction(subtract(key_light, view));
    const double gloss = 0.18 * std::pow(std::max(0.0, dot(normal, half)), 40);
    Colour colour{};
    for (std::size_t k = 0; k < 3; ++k) colour[k] = hit.colour[k] * (0.22 + 0.55 * key + 0.30 * fill) + gloss;
    return colour;
}

/// A sphere, from outside.
void meet_ball(const Ray& ray, const Point& centre, double radius, const Colour& colour, Hit& hit) {
    const Point offset = subtract(ray.origin, centre);
    const double b = dot(offset, ray.direction), c = dot(offset, offset) - radius * radius;
    const double discriminant = b * b - c;
    if (discriminant < 0) return;
    const double distance = -b - std::sqrt(discriminant);
    if (!(distance > 0) || distance >= hit.distance) return;
    hit.distance = distance;
    hit.normal = direction(subtract(add_scaled(ray.origin, distance, ray.direction), centre));
    hit.colour = colour;
}

/// The side of a cylinder between two points, from outside.
void meet_side(const Ray& ray, const PictureRod& rod, Hit& hit) {
    const Point axis = subtract(rod.end, rod.start);
    const double length = std::sqrt(dot(axis, axis));
    if (!(length > 0)) return;
    const Point along = runtime::scale(axis, 1 / length), offset = subtract(ray.origin, rod.start);
    const Point d = add_scaled(ray.direction, -dot(ray.direction, along), along);
    const Point o = add_scaled(offset, -dot(offset, along), along);
    const double a = dot(d, d), b = dot(o, d), c = dot(o, o) - rod.radius * rod.radius;
    const double discriminant = b * b - a * c;
    if (!(a > 0) || discriminant < 0) return;
    const double distance = (-b - std::sqrt(discriminant)) / a;
    const Point at = add_scaled(offset, distance, ray.direction);
    if (!(distance > 0) || distance >= hit.distance || dot(at, along) < 0 || dot(at, along) > length) return;
    hit.distance = distance;
    hit.normal = direction(add_scaled(at, -dot(at, along), along));
    hit.colour = rod.colour;
}

}  // namespace

/// Embree's objects, released with this.
struct Renderer::Device {
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = nullptr;

    Device() {
        if (device == nullptr) throw Error("pictures: Embree cannot start on this machine");
    }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device() {
        clear();
        rtcReleaseDevice(device);
    }

    void clear() {
        if (scene != nullptr) rtcReleaseScene(scene);
        scene = nullptr;
    }

    /// Adds the triangles of one surface; its number becomes that of the geometry.
    void add(const PictureSurface& surface, unsigned number) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surface.positions.size()));
        auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), surface.triangles.size()));
        for (const Point& position : surface.positions) {
            for (const double value : position) *vertices++ = static_cast<float>(value);
        }
        for (const mesh::Triangle& triangle : surface.triangles) {
            const bool is_drawn = std::ranges::all_of(triangle, [&](std::int32_t vertex) {
                return is_finite(surface.positions[static_cast<std::size_t>(vertex)]);
            });
            // A triangle of one vertex is met by no ray.
            for (const std::int32_t vertex : triangle) {
                *corners++ = static_cast<unsigned>(is_drawn ? vertex : triangle[0]);
            }
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, number);
        rtcReleaseGeometry(geometry);
    }

    void meet(const Ray& ray, std::span<const PictureSurface> surfaces, RTCIntersectContext& context, Hit& hit) {
        RTCRayHit query{};
        query.ray.org_x = static_cast<float>(ray.origin[0]);
        query.ray.org_y = static_cast<float>(ray.origin[1]);
        query.ray.org_z = static_cast<float>(ray.origin[2]);
        query.ray.dir_x = static_cast<float>(ray.direction[0]);
        query.ray.dir_y = static_cast<float>(ray.direction[1]);
        query.ray.dir_z = static_cast<float>(ray.direction[2]);
        query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.mask = ~0U;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
        const PictureSurface& surface = surfaces[query.hit.geomID];
        const auto triangle = static_cast<std::size_t>(query.hit.primID);
        hit.distance = static_cast<double>(query.ray.tfar);
        hit.normal = direction({static_cast<double>(query.hit.Ng_x), static_cast<double>(query.hit.Ng_y),
                                static_cast<double>(query.hit.Ng_z)});
        const bool is_marked = !surface.is_marked.empty() && surface.is_marked[triangle] != 0;
        hit.colour = is_marked ? surface.marked_colour : surface.colour;
        if (surface.normals.empty() || is_marked) return;
        const double u = static_cast<double>(query.hit.u), v = static_cast<double>(query.hit.v);
        const std::array<double, 3> weights{1 - u - v, u, v};
        Point smooth{};
        for (std::size_t k = 0; k < 3; ++k) {
            smooth = add_scaled(smooth, weights[k],
                                surface.normals[static_cast<std::size_t>(surface.triangles[triangle][k])]);
        }
        if (dot(smooth, smooth) > 0) hit.normal = direction(smooth);
    }
};

Renderer::Renderer(int width, int height) {
    if (width < 1 || height < 1 || width > 8192 || height > 8192) {
        throw Error("pictures: a size of " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels; expected 1 to 8192");
    }
    device_ = std::make_unique<Device>();
    picture_ = {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width * height))};
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Picture& Renderer::draw(const Camera& camera, std::span<const PictureSurface> surfaces,
                              std::span<const PictureRod> rods) {
    const Point forward = direction(subtract(camera.target, camera.eye));
    const Point right = direction(cross(forward, camera.up));
    if (right == Point{}) throw Error("pictures: the camera looks along its up direction, or nowhere");
    const Point up = cross(right, forward);
    device_->clear();
    device_->scene = rtcNewScene(device_->device);
    for (std::size_t number = 0; number < surfaces.size(); ++number) {
        const PictureSurface& surface = surfaces[number];
        const auto count = static_cast<std::int32_t>(surface.positions.size());
        for (const mesh::Triangle& triangle : surface.triangles) {
            if (std::ranges::any_of(triangle, [&](std::int32_t vertex) { return vertex < 0 || vertex >= count; })) {
                throw Error("pictures: a triangle has a vertex that does not exist; there are " +
                            std::to_string(count));
            }
        }
        if (!surface.triangles.empty()) device_->add(surface, static_cast<unsigned>(number));
    }
    rtcCommitScene(device_->scene);

    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const Point key_light = direction(add_scaled(add_scaled(runtime::scale(forward, -0.6), 0.7, up), -0.5, right));
    const double half = std::tan(camera.vertical_angle / 360 * std::numbers::pi);
    std::uint8_t* pixel = picture_.pixels.data();
    for (int y = 0; y < picture_.height; ++y) {
        const double v = (1 - 2 * (y + 0.5) / picture_.height) * half;
        for (int x = 0; x < picture_.width; ++x) {
            const double u = (2 * (x + 0.5) / picture_.width - 1) * half * picture_.width / picture_.height;
            const Ray ray{camera.eye, direction(add_scaled(add_scaled(forward, u, right), v, up))};
            Hit hit;
            device_->meet(ray, surfaces, context, hit);
            for (const PictureRod& rod : rods) {
                meet_side(ray, rod, hit);
                meet_ball(ray, rod.start, rod.radius, rod.colour, hit);
                meet_ball(ray, rod.end, rod.radius, rod.colour, hit);
            }
            Colour colour{};
            if (std::isfinite(hit.distance)) {
                colour = shaded(hit, ray.direction, key_light);
            } else {
                const double t = static_cast<double>(y) / picture_.height;
                for (std::size_t k = 0; k < 3; ++k) colour[k] = (1 - t) * sky[k] + t * ground[k];
            }
            for (const double value : colour) {
                *pixel++ = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
            }
        }
    }
    return picture_;
}

}  // namespace lancet::experiments
