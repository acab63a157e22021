#include "light/traced_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace strandcast {
namespace {

using Vec3d = Eigen::Vector3d;

constexpr float kThickestTraced = 0.1f;         // m
constexpr size_t kMostBoxes = size_t{1} << 23;  // boxes for which segments are halved: 90 bytes each
constexpr double kSurfaceGap = 2e-6;            // m above a surface at which rays start
constexpr double kFibreGap = 1e-3;              // of a hair's radius
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-14;  // sine squared below which a ray runs along the surface

/// The smallest float above, so that Embree keeps boxes that may hold the same distance.
float roundedUp(double value) {
  return value < static_cast<double>(std::numeric_limits<float>::max())
             ? std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity())
             : std::numeric_limits<float>::infinity();
}

void throwEmbree(RTCDevice device, const char* what) {
  throw Error(fmt::format("Embree cannot {}", what), "path tracer",
              fmt::format("code {}; is there enough memory?", static_cast<int>(rtcGetDeviceError(device))));
}

[[noreturn]] void refuseHair(const std::string& what, size_t hair, const char* remedy) {
  throw Error(what, fmt::format("hair {}", hair), remedy);
}

void checkTracedHair(const TracedHair& hair) {
  const size_t vertices = hair.positions.size();
  if (hair.offsets.empty() || hair.offsets.front() != 0 || hair.offsets.back() != vertices ||
      hair.tangents.size() != vertices || hair.radii.size() != vertices ||
      hair.absorption.size() != hair.hairs())
    throw Error("the hairs of a picture are damaged", "path tracer", "their arrays do not fit together");
  for (size_t h = 0; h < hair.hairs(); ++h) {
    if (hair.offsets[h + 1] < hair.offsets[h])
      throw Error("the hairs of a picture are damaged", "path tracer", "their offsets decrease");
    for (const Vec3& end : hair.absorption[h])
      for (const float a : end)
        if (!(a >= 0 && std::isfinite(a)))
          refuseHair(fmt::format("the absorption of a hair is {:g}", a), h, "give a number of 0 or more");
    for (size_t v = hair.offsets[h]; v < hair.offsets[h + 1]; ++v) {
      if (!(hair.radii[v] > 0 && hair.radii[v] <= kThickestTraced))
        refuseHair(fmt::format("the radius of a hair is {:g} m", hair.radii[v]), h,
                   "give more than 0, up to 0.1 m");
      if (!hair.positions[v].allFinite() || !hair.tangents[v].allFinite())
        refuseHair("a vertex of a hair is not finite", h, "leave the hair out");
    }
  }
}

bool isTraceable(const TriangleMesh& mesh, const std::array<uint32_t, 3>& triangle) {
  return std::ranges::all_of(triangle, [&](uint32_t corner) {
    return corner < mesh.positions.size() && mesh.positions[corner].allFinite();
  });
}

Vec3d vectorOf(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

/// Two scenes, as hair is queried up to the distance of the nearest triangle. A device of one thread builds
/// the triangles' tree: it is the same whatever the number of threads. Hair does not need that: of equal
/// distances its test prefers the lower segment.
struct TracedScene::Embree {
  RTCDevice surface_device = rtcNewDevice("threads=1"), hair_device = rtcNewDevice(nullptr);
  RTCScene surfaces = nullptr, hair = nullptr;

  ~Embree() {
    for (RTCScene scene : {surfaces, hair})
      if (scene != nullptr) rtcReleaseScene(scene);
    for (RTCDevice device : {surface_device, hair_device})
      if (device != nullptr) rtcReleaseDevice(device);
  }
};

/// Embree's context of one ray through hair, with the exact ray.
struct TracedScene::Query {
  RTCIntersectContext context;  // first, as Embree passes its address
  const TracedScene* scene;
  Vec3d start, direction;
  double nearest;    ///< m, of the hit so far
  uint32_t segment;  ///< that is met there
  uint32_t left;     ///< segment that the ray leaves

  static void bounds(const RTCBoundsFunctionArguments* arguments);
  bool meets(uint32_t box);
  static void intersect(const RTCIntersectFunctionNArguments* arguments);
  static void occlude(const RTCOccludedFunctionNArguments* arguments);
};

/// m along the ray to where it enters a segment from outside; infinite where it does not. The solid is
/// convex: the intersection of the slab between its ends with the cone.
double TracedScene::enter(const Segment& s, const Vec3d& start, const Vec3d& direction) {
  const Vec3d begin = vectorOf(s.begin), axis = vectorOf(s.end) - begin, off = start - begin;
  const double length2 = axis.squaredNorm(), speed = direction.dot(axis), behind = off.dot(axis);
  double enters = -kInfinity, leaves = kInfinity;
  if (speed != 0) {
    const double a = -behind / speed, b = (length2 - behind) / speed;
    enters = std::min(a, b);
    leaves = std::max(a, b);
  } else if (behind < 0 || behind > length2) {
    return kInfinity;
  }
  if (leaves <= 0) return kInfinity;
  // |aside + t across|^2 = (radius + t widening)^2
  const double taper = static_cast<double>(s.end_radius) - static_cast<double>(s.begin_radius);
  const Vec3d aside = off - axis * (behind / length2), across = direction - axis * (speed / length2);
  const double radius = static_cast<double>(s.begin_radius) + taper * behind / length2,
               widening = taper * speed / length2;
  const double a = across.squaredNorm() - widening * widening, b = aside.dot(across) - radius * widening,
               c = aside.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (a > kParallel) {
    if (discriminant < 0) return kInfinity;
    const double root = std::sqrt(discriminant);
    enters = std::max(enters, (-b - root) / a);
    leaves = std::min(leaves, (-b + root) / a);
  } else if (a < -kParallel) {
    // Steeper than the cone: inside from the farther root on where it widens, up to the nearer where it
    // narrows.
    if (discriminant > 0) {
      const double root = std::sqrt(discriminant);
      if (widening > 0)
        enters = std::max(enters, (-b - root) / a);
      else
        leaves = std::min(leaves, (-b + root) / a);
    }
  } else if (b != 0) {
    (b > 0 ? leaves : enters) = b > 0 ? std::min(leaves, -c / (2 * b)) : std::max(enters, -c / (2 * b));
  } else if (c > 0) {
    return kInfinity;
  }
  return enters <= leaves && enters > 0 ? enters : kInfinity;
}

void TracedScene::Query::bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& scene = *static_cast<const TracedScene*>(arguments->geometryUserPtr);
  const Segment& s = scene.segments_[arguments->primID / static_cast<unsigned>(scene.boxes_)];
  const auto number = static_cast<float>(arguments->primID % static_cast<unsigned>(scene.boxes_));
  const float from = number / static_cast<float>(scene.boxes_),
              to = (number + 1) / static_cast<float>(scene.boxes_);
  float* low = &arguments->bounds_o->lower_x;
  float* high = &arguments->bounds_o->upper_x;
  const float radius = 1.0001f * std::max(s.begin_radius, s.end_radius) + 1e-7f;
  for (int i = 0; i < 3; ++i) {
    const float a = s.begin[i] + from * (s.end[i] - s.begin[i]),
                b = s.begin[i] + to * (s.end[i] - s.begin[i]);
    low[i] = std::min(a, b) - radius;
    high[i] = std::max(a, b) + radius;
  }
}

bool TracedScene::Query::meets(uint32_t box) {
  const uint32_t number = box / static_cast<uint32_t>(scene->boxes_);
  if (number == left) return false;
  const double distance = enter(scene->segments_[number], start, direction);
  if (!(distance < nearest || (distance == nearest && number < segment && distance < kInfinity)))
    return false;
  nearest = distance;
  segment = number;
  return true;
}

void TracedScene::Query::intersect(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  if (!query.meets(arguments->primID)) return;
  auto& found = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  found.ray.tfar = roundedUp(query.nearest);
  found.hit.geomID = arguments->geomID;
  found.hit.primID = arguments->primID;
}

void TracedScene::Query::occlude(const RTCOccludedFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  if (query.meets(arguments->primID))
    reinterpret_cast<RTCRay*>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
}

TracedScene::TracedScene(TracedHair hair, std::vector<TracedMesh> meshes)
    : hair_(std::move(hair)), meshes_(std::move(meshes)), embree_(std::make_unique<Embree>()) {
  checkTracedHair(hair_);
  Box box;
  for (const Vec3& p : hair_.positions) box.extend(Eigen::Vector3f(p));
  for (TracedMesh& part : meshes_) {
    std::erase_if(part.mesh.triangles,
                  [&](const auto& triangle) { return !isTraceable(part.mesh, triangle); });
    for (const auto& triangle : part.mesh.triangles)
      for (const uint32_t corner : triangle) box.extend(Eigen::Vector3f(part.mesh.positions[corner]));
  }
  if (!box.isEmpty()) {
    origin_ = box.center().cast<double>();
    radius_ = box.diagonal().cast<double>().norm() / 2;
  }
  if (embree_->surface_device == nullptr || embree_->hair_device == nullptr) throwEmbree(nullptr, "start");

  embree_->surfaces = rtcNewScene(embree_->surface_device);
  rtcSetSceneFlags(embree_->surfaces, RTC_SCENE_FLAG_ROBUST);
  for (size_t m = 0; m < meshes_.size(); ++m) {
    const TriangleMesh& mesh = meshes_[m].mesh;
    if (mesh.triangles.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(embree_->surface_device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangles.size()));
    if (vertices == nullptr || indices == nullptr) throwEmbree(embree_->surface_device, "take the surfaces");
    for (const Vec3& p : mesh.positions) {
      const Vec3d near = p.allFinite() ? Vec3d(p.cast<double>() - origin_) : Vec3d::Zero().eval();
      for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(near[i]);
    }
    for (const auto& triangle : mesh.triangles)
      indices = std::copy(triangle.begin(), triangle.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree_->surfaces, geometry, static_cast<unsigned>(m));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_->surfaces);
  if (rtcGetDeviceError(embree_->surface_device) != RTC_ERROR_NONE)
    throwEmbree(embree_->surface_device, "sort the surfaces");

  for (size_t h = 0; h < hair_.hairs(); ++h)
    for (uint32_t v = hair_.offsets[h]; v + 1 < hair_.offsets[h + 1]; ++v) {
      Segment s{};
      for (int i = 0; i < 3; ++i) {
        s.begin[i] = static_cast<float>(static_cast<double>(hair_.positions[v][i]) - origin_[i]);
        s.end[i] = static_cast<float>(static_cast<double>(hair_.positions[v + 1][i]) - origin_[i]);
      }
      s.begin_radius = hair_.radii[v];
      s.end_radius = hair_.radii[v + 1];
      s.hair = static_cast<uint32_t>(h);
      s.vertex = v;
      if (vectorOf(s.begin) != vectorOf(s.end)) segments_.push_back(s);
    }
  boxes_ = 2 * segments_.size() <= kMostBoxes ? 2 : 1;
  embree_->hair = rtcNewScene(embree_->hair_device);
  rtcSetSceneFlags(embree_->hair, RTC_SCENE_FLAG_ROBUST);
  if (!segments_.empty()) {
    RTCGeometry geometry = rtcNewGeometry(embree_->hair_device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry,
                                     static_cast<unsigned>(segments_.size() * static_cast<size_t>(boxes_)));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, Query::bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, Query::intersect);
    rtcSetGeometryOccludedFunction(geometry, Query::occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree_->hair, geometry, 0);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_->hair);
  if (rtcGetDeviceError(embree_->hair_device) != RTC_ERROR_NONE)
    throwEmbree(embree_->hair_device, "sort the hair");
}

TracedScene::~TracedScene() = default;

namespace {

RTCRay embreeRay(const Vec3d& start, const Vec3d& direction, double distance) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(start.x());
  ray.org_y = static_cast<float>(start.y());
  ray.org_z = static_cast<float>(start.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = roundedUp(distance);
  ray.mask = ~0u;
  return ray;
}

}  // namespace

TracedHit TracedScene::hit(const Vec3d& start, const Vec3d& direction, const TracedHit* left) const {
  TracedHit result;
  RTCRayHit found{};
  found.ray = embreeRay(start, direction, kInfinity);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->surfaces, &context, &found);
  Query query{{}, this, start, direction, kInfinity, ~0u, ~0u};
  if (left != nullptr && left->kind == TracedHit::Kind::kHair) query.left = left->primitive;
  if (found.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
    result.kind = TracedHit::Kind::kSurface;
    query.nearest = result.distance = static_cast<double>(found.ray.tfar);
    result.part = found.hit.geomID;
    result.primitive = found.hit.primID;
  }
  const double u = static_cast<double>(found.hit.u), v = static_cast<double>(found.hit.v);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcInitIntersectContext(&query.context);
  rtcIntersect1(embree_->hair, &query.context, &found);
  if (query.segment != ~0u) {
    result.kind = TracedHit::Kind::kHair;
    result.distance = query.nearest;
    result.primitive = query.segment;
    completeHair(result, start, direction);
  } else if (result.kind == TracedHit::Kind::kSurface) {
    completeSurface(result, u, v, direction);
  }
  return result;
}

void TracedScene::completeHair(TracedHit& hit, const Vec3d& start, const Vec3d& direction) const {
  const Segment& s = segments_[hit.primitive];
  const Vec3d begin = vectorOf(s.begin), whole = vectorOf(s.end) - begin;
  hit.position = start + hit.distance * direction;
  const double part = std::clamp((hit.position - begin).dot(whole) / whole.squaredNorm(), 0.0, 1.0);
  hit.part = s.hair;
  hit.axis = whole.normalized();
  hit.center = begin + part * whole;
  hit.radius = static_cast<double>(s.begin_radius) +
               part * (static_cast<double>(s.end_radius) - static_cast<double>(s.begin_radius));
  const Vec3d tangent = (1 - part) * hair_.tangents[s.vertex].cast<double>() +
                        part * hair_.tangents[s.vertex + 1].cast<double>();
  hit.tangent = tangent.squaredNorm() > 1e-6 && tangent.dot(hit.axis) > 0 ? tangent.normalized() : hit.axis;
  const uint32_t first = hair_.offsets[s.hair], last = hair_.offsets[s.hair + 1] - 1;
  hit.along = (static_cast<double>(s.vertex - first) + part) / static_cast<double>(last - first);
}

void TracedScene::completeSurface(TracedHit& hit, double u, double v, const Vec3d& direction) const {
  const TriangleMesh& mesh = meshes_[hit.part].mesh;
  const std::array<uint32_t, 3>& corners = mesh.triangles[hit.primitive];
  const auto corner = [&](int i) {
    return Vec3d(mesh.positions[corners[static_cast<size_t>(i)]].cast<double>() - origin_);
  };
  const double weights[3] = {1 - u - v, u, v};
  hit.position = weights[0] * corner(0) + weights[1] * corner(1) + weights[2] * corner(2);
  hit.normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  hit.shading = hit.normal;
  if (mesh.normals.size() == mesh.positions.size()) {
    Vec3d smooth = Vec3d::Zero();
    for (size_t i = 0; i < 3; ++i) smooth += weights[i] * mesh.normals[corners[i]].cast<double>();
    if (smooth.allFinite() && smooth.squaredNorm() > 1e-12) hit.shading = smooth.normalized();
  }
  if (hit.normal.dot(direction) > 0) hit.normal = -hit.normal;
  if (hit.shading.dot(hit.normal) < 0) hit.shading = -hit.shading;
}

bool TracedScene::isBlocked(const Vec3d& start, const Vec3d& direction, double distance,
                            const TracedHit* left) const {
  RTCRay ray = embreeRay(start, direction, distance);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->surfaces, &context, &ray);
  if (ray.tfar < 0) return true;
  Query query{{}, this, start, direction, distance, 0, ~0u};
  if (left != nullptr && left->kind == TracedHit::Kind::kHair) query.left = left->primitive;
  rtcInitIntersectContext(&query.context);
  rtcOccluded1(embree_->hair, &query.context, &ray);
  return ray.tfar < 0;
}

Vec3d TracedScene::departure(const TracedHit& hit, const Vec3d& direction) const {
  if (hit.kind == TracedHit::Kind::kSurface)
    return hit.position + (direction.dot(hit.normal) < 0 ? -kSurfaceGap : kSurfaceGap) * hit.normal;
  Vec3d across = direction - direction.dot(hit.axis) * hit.axis;
  const double length = across.norm();
  across = length > 1e-9 ? Vec3d(across / length) : Vec3d(hit.axis.unitOrthogonal());
  return hit.center + (1 + kFibreGap) * hit.radius * across;
}

}  // namespace strandcast
