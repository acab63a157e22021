#include "core/contact_primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/broad_phase.h"
#include "core/error.h"
#include "core/geometry.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
namespace kernels::f32 {
#include "core/body_surface.inl"
}  // namespace kernels::f32

namespace {

/// Shortest half axis of an ellipsoid, m. Distances are computed in units of it, and those of far points must
/// remain finite.
constexpr float kMinHalfAxis = 1e-6f;

void put(float (&out)[3], const Vec3& v) {
  for (int c = 0; c < 3; ++c) out[c] = v[c];
}
void put(float (&out)[4], const Quat& q) {
  for (int c = 0; c < 4; ++c) out[c] = q.coeffs()[c];
}

Vec3 middleOf(const FieldGrid& grid) {
  const Vec3 bricks = Vec3(static_cast<float>(grid.bricks[0]), static_cast<float>(grid.bricks[1]),
                           static_cast<float>(grid.bricks[2]));
  return Vec3(grid.origin) + 0.5f * grid.cell * kBrickCells * bricks;
}

/// Bounding ball about the point that the shape rotates about; that point is in the shape's own frame.
struct Turning {
  Vec3 middle = Vec3::Zero();
  float radius = 0;
};
Turning turningOf(const ContactPrimitive& p) {
  switch (p.kind) {
    case PrimitiveKind::kEllipsoid:
      return {Vec3::Zero(), p.extent.maxCoeff()};
    case PrimitiveKind::kBox:
      return {Vec3::Zero(), p.extent.norm()};
    case PrimitiveKind::kConvex:
      return {p.convex->bounds.center(), 0.5f * p.convex->bounds.diagonal().norm()};
    case PrimitiveKind::kField: {
      const Vec3 middle = middleOf(p.field->grid);
      return {middle, (middle - Vec3(p.field->grid.origin)).norm()};
    }
    default:
      return {};
  }
}

uint64_t nextRevision() {
  static std::atomic<uint64_t> newest{0};
  return ++newest;
}

}  // namespace

void checkPrimitive(const ContactPrimitive& p, const std::string& where) {
  if (static_cast<uint32_t>(p.kind) > static_cast<uint32_t>(PrimitiveKind::kField))
    throw Error("unknown kind of body shape", where, "give a PrimitiveKind");
  if (!p.a.allFinite() || !p.b.allFinite() || !std::isfinite(p.radius) || !std::isfinite(p.friction) ||
      !std::isfinite(p.radius_b) || !p.extent.allFinite() || !p.rotation.coeffs().allFinite())
    throw Error("a body's shape is not finite", where, "check its points, sizes, rotation and friction");
  if (p.radius < 0 || p.radius_b < 0 || p.friction < 0)
    throw Error("a body's radius or friction is negative", where, "give 0 or more");
  const bool has_radius = p.kind == PrimitiveKind::kSphere || p.kind == PrimitiveKind::kCapsule ||
                          p.kind == PrimitiveKind::kTaperedCapsule;
  const float thickest = p.kind == PrimitiveKind::kTaperedCapsule ? std::max(p.radius, p.radius_b) : p.radius;
  if (has_radius && !(thickest > 0)) throw Error("a body has no size", where, "give a radius above 0");
  if (p.kind == PrimitiveKind::kPlane && std::fabs(p.b.norm() - 1) > 1e-3f)
    throw Error("a plane's normal is not of unit length", where, "normalise it");
  const bool turns = p.kind >= PrimitiveKind::kEllipsoid;
  if (turns && std::fabs(p.rotation.norm() - 1) > 1e-3f)
    throw Error("a body's rotation is not of unit length", where, "normalise it");
  if ((p.kind == PrimitiveKind::kEllipsoid || p.kind == PrimitiveKind::kBox) && !(p.extent.minCoeff() > 0))
    throw Error("a body has no extent", where, "give half axes or half edges above 0");
  if (p.kind == PrimitiveKind::kEllipsoid && !(p.extent.minCoeff() >= kMinHalfAxis))
    throw Error("an ellipsoid's half axis is shorter than a micrometre", where, "give it in metres");
  if (p.kind == PrimitiveKind::kEllipsoid && p.extent.maxCoeff() > 100 * p.extent.minCoeff())
    throw Error("an ellipsoid's half axes differ by more than a factor of 100", where,
                "use a box or a distance field for such a flat body");
  if (p.kind == PrimitiveKind::kConvex && (p.convex == nullptr || p.convex->planes.size() < 4))
    throw Error("a convex body has no planes", where, "make it with convexBody()");
  if (p.kind == PrimitiveKind::kField && (p.field == nullptr || p.field->index.empty()))
    throw Error("a body has no distance field", where, "bake it (FieldBaker)");
  const Turning turning = turningOf(p);
  const Vec3 places = p.a.cwiseAbs().cwiseMax(turning.middle.cwiseAbs());
  const Vec3 second = p.kind == PrimitiveKind::kPlane ? Vec3(Vec3::Zero()) : Vec3(p.b.cwiseAbs());
  const float sizes = std::max({p.radius, p.radius_b, p.extent.cwiseAbs().maxCoeff(), turning.radius});
  if (!(std::max({places.maxCoeff(), second.maxCoeff(), sizes}) <= kFarthestPose))
    throw Error("a body's shape is larger, or farther from its origin, than 10 km", where,
                "give points and sizes in metres");
}

uint32_t ShapeData::add(const ContactPrimitive& primitive) {
  const bool convex = primitive.kind == PrimitiveKind::kConvex;
  if (!convex && primitive.kind != PrimitiveKind::kField) return 0;
  const void* shape = convex ? static_cast<const void*>(primitive.convex.get()) : primitive.field.get();
  for (const auto& [known, at] : known_)
    if (known == shape) return at;
  const size_t first = words.size();
  const Vec3 middle = turningOf(primitive).middle;
  if (convex) {
    for (const std::array<float, 4>& plane : primitive.convex->planes) {
      const float distance = plane[3] - Vec3(plane[0], plane[1], plane[2]).dot(middle);
      for (const float number : {plane[0], plane[1], plane[2], distance})
        words.push_back(std::bit_cast<uint32_t>(number));
    }
  } else {
    const DistanceField& field = *primitive.field;
    const std::vector<uint32_t> evenness = field.evenness();
    FieldGrid grid = field.grid;
    put(grid.origin, Vec3(grid.origin) - middle);
    constexpr size_t kHeader = sizeof(FieldGrid) / sizeof(uint32_t);
    const size_t index = first + kHeader, samples = index + field.index.size(),
                 corners = samples + field.samples.size(), even = corners + field.corners.size(),
                 end = even + evenness.size();
    // The CPU backends use signed 32-bit byte offsets into a field's samples (wordAtByte).
    if (sizeof(uint32_t) * field.samples.size() > std::numeric_limits<int32_t>::max())
      throw Error("a distance field is too large", std::to_string(field.samples.size()) + " words of samples",
                  "bake it with larger cells");
    if (end > std::numeric_limits<uint32_t>::max())
      throw Error("the distance fields of all bodies together are too large", std::to_string(end) + " words",
                  "bake them with larger cells");
    grid.index = static_cast<uint32_t>(index);
    grid.samples = static_cast<uint32_t>(samples);
    grid.corners = static_cast<uint32_t>(corners);
    words.resize(end);
    std::memcpy(words.data() + first, &grid, sizeof grid);
    std::copy(field.index.begin(), field.index.end(), words.begin() + static_cast<ptrdiff_t>(index));
    std::copy(field.samples.begin(), field.samples.end(), words.begin() + static_cast<ptrdiff_t>(samples));
    std::transform(field.corners.begin(), field.corners.end(),
                   words.begin() + static_cast<ptrdiff_t>(corners),
                   [](float distance) { return std::bit_cast<uint32_t>(distance); });
    std::copy(evenness.begin(), evenness.end(), words.begin() + static_cast<ptrdiff_t>(even));
  }
  known_.emplace_back(shape, static_cast<uint32_t>(first));
  revision = nextRevision();
  return static_cast<uint32_t>(first);
}

uint32_t ShapeData::addBend() {
  const size_t first = words.size();
  if (first + kBendWords > std::numeric_limits<uint32_t>::max())
    throw Error("the shapes of all bodies together are too large", std::to_string(first) + " words",
                "bake their distance fields with larger cells");
  words.resize(first + kBendWords);
  bends.push_back(static_cast<uint32_t>(first));
  revision = nextRevision();
  return bends.back();
}

void ShapeData::setBend(uint32_t at, const MovingBend& bend) {
  std::memcpy(words.data() + at, &bend, sizeof bend);
}

void ShapeData::clear() {
  words.clear();
  bends.clear();
  known_.clear();
  revision = nextRevision();
}

MovingPrimitive moved(const ContactPrimitive& primitive, const Pose& begin, const Pose& end, float dt,
                      uint32_t data) {
  MovingPrimitive out{};
  out.kind = static_cast<uint32_t>(primitive.kind);
  out.radius = primitive.radius;
  out.radius_b = primitive.radius_b;
  out.friction = primitive.friction;
  put(out.extent, primitive.extent);
  out.data = data;
  Vec3 a = primitive.a;
  if (primitive.kind >= PrimitiveKind::kEllipsoid) {
    const Turning turning = turningOf(primitive);
    out.radius = turning.radius;
    a += primitive.rotation * turning.middle;
    if (primitive.convex) out.extra = static_cast<uint32_t>(primitive.convex->planes.size());
  }
  put(out.rotation_begin, (begin.rotation * primitive.rotation).normalized());
  put(out.rotation_end, (end.rotation * primitive.rotation).normalized());
  put(out.a_begin, begin.apply(a));
  put(out.a_end, end.apply(a));
  const bool direction = primitive.kind == PrimitiveKind::kPlane;
  put(out.b_begin, direction ? begin.rotate(primitive.b) : begin.apply(primitive.b));
  put(out.b_end, direction ? end.rotate(primitive.b) : end.apply(primitive.b));
  const Eigen::AngleAxisf turn(Eigen::Quaternionf(end.rotation * begin.rotation.conjugate()));
  put(out.angular_velocity, turn.axis() * (turn.angle() / dt));
  return out;
}

MovingBend bendOf(const ContactPrimitive& field, const SurfaceBend& begin, const SurfaceBend& end) {
  const FieldGrid& grid = field.field->grid;
  const Vec3 middle = middleOf(grid);
  return movingBend(begin, end, field.a + middle, middle - Vec3(grid.origin));
}

void applyBend(MovingPrimitive& field, const MovingBend& bend, uint32_t at) {
  if (bend.stretch == 0) return;
  field.extra = at;
  field.radius += farthestShift(bend);
}

float signedDistance(const MovingPrimitive& primitive, const Vec3& point, std::span<const uint32_t> words) {
  const auto body = kernels::f32::bodyAt(primitive, words.data(), 1, 1, 1, 0);
  return kernels::f32::surfaceAt(body, {point.x(), point.y(), point.z()}, 0, true).distance;
}

Box sweptBox(const MovingPrimitive& p) {
  const auto kind = static_cast<PrimitiveKind>(p.kind);
  if (kind == PrimitiveKind::kPlane) {
    return {Eigen::Vector3f::Constant(-kEndless), Eigen::Vector3f::Constant(kEndless)};
  }
  Box box(Eigen::Vector3f(p.a_begin));
  box.extend(Eigen::Vector3f(p.a_end));
  float radius = p.radius;
  if (kind == PrimitiveKind::kCapsule || kind == PrimitiveKind::kTaperedCapsule) {
    box.extend(Eigen::Vector3f(p.b_begin)).extend(Eigen::Vector3f(p.b_end));
    if (kind == PrimitiveKind::kTaperedCapsule) radius = std::max(radius, p.radius_b);
  }
  box.min().array() -= radius;
  box.max().array() += radius;
  return box;
}

namespace {

constexpr size_t kMaxPlanes = 1024;  // each contact query tests all of them

}  // namespace

ConvexBody convexBody(const TriangleMesh& mesh, float tolerance) {
  const std::string name = mesh.name.empty() ? "mesh" : "mesh " + mesh.name;
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    if (!mesh.positions[v].allFinite())
      throw Error("a vertex is not finite", fmt::format("{}, vertex {}", name, v), "repair the mesh");
  ConvexBody body;
  body.bounds = mesh.bounds();
  const float near = tolerance * body.bounds.diagonal().norm();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Vec3& p : mesh.positions)
    middle += p.cast<double>() / static_cast<double>(mesh.positions.size());
  Eigen::Vector3d open = Eigen::Vector3d::Zero();  // sum of area vectors: zero for a closed surface
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int c = 0; c < 3; ++c) corner[c] = mesh.positions[mesh.triangles[t][c]].cast<double>();
    Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double size = normal.norm();
    if (!(size > 0)) continue;
    normal /= normal.dot(corner[0] - middle) < 0 ? -size : size;
    open += size * normal;
    area += size;
    const double distance = normal.dot(corner[0]);
    const auto same = [&](const std::array<float, 4>& plane) {
      return (Eigen::Vector3d(plane[0], plane[1], plane[2]) - normal).norm() < tolerance &&
             std::fabs(plane[3] - distance) < near;
    };
    if (std::any_of(body.planes.begin(), body.planes.end(), same)) continue;
    for (const Vec3& p : mesh.positions) {
      const double before = normal.dot(p.cast<double>()) - distance;
      if (before > near)
        throw Error(
            fmt::format("the mesh is not convex: a vertex lies {:.3g} m outside a triangle's plane", before),
            fmt::format("{}, triangle {}", name, t), "bake a distance field of it instead");
    }
    if (body.planes.size() == kMaxPlanes)
      throw Error(fmt::format("the convex body has more than {} planes", kMaxPlanes), name,
                  "bake a distance field of it instead");
    const Eigen::Vector3f n = normal.cast<float>();
    body.planes.push_back({n.x(), n.y(), n.z(), static_cast<float>(distance)});
  }
  const auto before_middle = [&](const std::array<float, 4>& plane) {
    return Eigen::Vector3d(plane[0], plane[1], plane[2]).dot(middle) - plane[3] > -near;
  };
  if (body.planes.size() < 4 || std::any_of(body.planes.begin(), body.planes.end(), before_middle))
    throw Error("the mesh has no volume", name, "give a closed convex mesh");
  if (open.norm() > 1e-3 * area) throw Error("the mesh is open", name, "give a closed convex mesh");
  return body;
}

}  // namespace strandcast
