#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

constexpr int kCounts[] = {2, 3, 5, 16, 17, 31, 100, 128};

Vec3 randomVector(std::mt19937& random) {
  std::uniform_real_distribution<float> range(-1, 1);
  const float x = range(random), y = range(random), z = range(random);
  return {x, y, z};
}

}  // namespace

StrandModel awkwardModel(size_t strands, uint32_t seed, const std::vector<Material>& materials) {
  std::mt19937 random(seed);
  StrandSet set;
  for (size_t s = 0; s < strands; ++s) {
    const int vertices = kCounts[(s * 5 + 3) % std::size(kCounts)];
    const float edge = (0.05f + 0.35f * (s % 7) / 6.0f) / (vertices - 1);
    Vec3 x = 0.1f * randomVector(random).cwiseProduct(Vec3(1, 0.1f, 1));
    Vec3 direction = (Vec3(0, 0.5f, 0) + randomVector(random)).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < vertices; ++i) {
      points.push_back(x);
      x += edge * direction;
      direction = (direction + 0.3f * randomVector(random)).normalized();
    }
    set.append(points);
    set.pinned.resize(set.vertices(), 0);
    if (s % 5 == 4) set.pinned.back() = 1;
    set.parts.push_back(static_cast<uint16_t>(s % 3));
  }
  return makeStrandModel(set, materials);
}

std::vector<Material> groomedMaterials() {
  Material styled, stiff;
  styled.air_drag_scale.knots = {{0, 1}, {1, 8}};
  styled.goal_scale.knots = {{0, 1}, {0.7f, 0}};
  styled.friction_scale = 0.25f;
  stiff.air_drag_scale.knots = {{0, 0}};
  stiff.damping_scale = 3;
  return {Material{}, styled, stiff};
}

void tieToBones(StrandModel& model) {
  model.bones = {"head", "clip", "ribbon"};
  for (size_t s = 0; s < model.strands(); ++s) {
    const float nearest = 1.0f / static_cast<float>(model.verticesOf(s) - 1);  // spans a vertex at least
    if (s % 4 == 0) pinToBone(model, s, 0.5f, std::min(0.5f + nearest, 1.0f), "ribbon");
    if (s % 8 == 1) pinToBone(model, s, 0, 1, "clip");
    if (s % 4 == 2 && model.verticesOf(s) > 3) {  // two edges cannot keep their length between two pins
      pinToBone(model, s, 0, 0, "clip");
      pinToBone(model, s, 1, 1, "head");
    }
  }
}

std::vector<Pose> movedBones() {
  auto pose = [](Vec3 position, float angle) {
    return Pose{position, Quat(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, 3).normalized()))};
  };
  return {pose({0.001f, 0, 0}, 0.002f), pose({0, 0.0007f, 0}, -0.004f), pose({0, 0, -0.0012f}, 0.005f)};
}

StrandState disturbedState(const StrandModel& model, uint32_t seed) {
  std::mt19937 random(seed);
  StrandState state = restState(model, model.rest_roots);
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s] + 1; v < model.offsets[s + 1]; ++v) {
      const float edge = (model.rest_local[v] - model.rest_local[v - 1]).norm();
      state.positions[v] += 0.2f / std::sqrt(3.0f) * edge * randomVector(random);
      state.velocities[v] = randomVector(random) / std::sqrt(3.0f);
    }
  }
  return state;
}

StrandState nudged(StrandState state, uint32_t seed) {
  std::mt19937 random(seed);
  for (std::vector<Vec3>* values : {&state.positions, &state.velocities})
    for (Vec3& value : *values)
      for (int c = 0; c < 3; ++c) value[c] *= (random() & 1) != 0 ? 1 + 6e-8f : 1 - 6e-8f;
  return state;
}

std::vector<MovingPrimitive> movingBodies(float dt) {
  auto pose = [](Vec3 position, float angle) {
    return Pose{position, Quat(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, 3).normalized()))};
  };
  ContactPrimitive sphere{PrimitiveKind::kSphere, Vec3(0, 0, 0.02f), Vec3::UnitY(), 0.09f, 0.4f};
  ContactPrimitive capsule{PrimitiveKind::kCapsule, Vec3(-0.1f, 0, 0), Vec3(0.1f, 0.05f, 0), 0.05f, 0.8f};
  ContactPrimitive plane{PrimitiveKind::kPlane, Vec3(0, 0, 0), Vec3(0.1f, 1, 0).normalized(), 0, 0.2f};
  return {moved(sphere, pose({0, -0.08f, 0}, 0), pose({0.01f, -0.07f, 0}, 0.2f), dt),
          moved(capsule, pose({0, 0.1f, 0.1f}, 0.1f), pose({0, 0.09f, 0.1f}, -0.1f), dt),
          moved(plane, pose({0, -0.15f, 0}, 0), pose({0, -0.14f, 0}, 0.02f), dt)};
}

std::vector<float> restDistancesAtStart(const StrandState& from, std::span<const MovingPrimitive> bodies,
                                        std::span<const uint32_t> words) {
  constexpr float kDeeper = 1e-3f;  // m
  std::vector<float> distances(from.positions.size(), kFarFromBodies);
  for (size_t v = 0; v < distances.size(); ++v)
    for (const MovingPrimitive& body : bodies)
      distances[v] = std::min(distances[v], signedDistance(body, from.positions[v], words) - kDeeper);
  return distances;
}

DistanceField sampledField(const std::function<float(const Vec3&)>& distance, const Box& box, float cell,
                           float band) {
  DistanceField field;
  FieldGrid& grid = field.grid;
  const float brick = cell * kBrickCells, diagonal = std::sqrt(3.0f) * brick;
  grid.cell = cell;
  grid.band = band;
  grid.quantum = (band + cell + diagonal) / 32767;
  for (int c = 0; c < 3; ++c) {
    grid.bricks[c] = static_cast<uint32_t>(std::ceil((box.sizes()[c] + 2 * band) / brick));
    grid.origin[c] = box.center()[c] - 0.5f * brick * static_cast<float>(grid.bricks[c]);
  }
  const auto at = [&](uint32_t i, uint32_t j, uint32_t k) { return distance(samplePosition(grid, i, j, k)); };
  for (uint32_t z = 0; z < grid.bricks[2]; ++z)
    for (uint32_t y = 0; y < grid.bricks[1]; ++y)
      for (uint32_t x = 0; x < grid.bricks[0]; ++x) {
        const uint32_t i = kBrickCells * x, j = kBrickCells * y, k = kBrickCells * z;
        const float middle = at(i + kBrickCells / 2, j + kBrickCells / 2, k + kBrickCells / 2);
        if (std::fabs(middle) > band + diagonal / 2) {
          field.index.push_back(middle < 0 ? kInsideBrick : kOutsideBrick);
          continue;
        }
        field.index.push_back(static_cast<uint32_t>(field.storedBricks()));
        const size_t first = field.samples.size();
        field.samples.resize(first + kBrickWords);
        for (uint32_t n = 0; n < kBrickSamples; ++n) {
          const float exact =
              at(i + n % kBrickSide, j + n / kBrickSide % kBrickSide, k + n / kBrickSide / kBrickSide);
          const auto stored = static_cast<uint16_t>(static_cast<int16_t>(std::lround(exact / grid.quantum)));
          field.samples[first + n / 2] |= uint32_t{stored} << (16 * (n % 2));
        }
      }
  for (uint32_t z = 0; z <= grid.bricks[2]; ++z)
    for (uint32_t y = 0; y <= grid.bricks[1]; ++y)
      for (uint32_t x = 0; x <= grid.bricks[0]; ++x)
        field.corners.push_back(at(kBrickCells * x, kBrickCells * y, kBrickCells * z));
  return field;
}

SurfaceBend bendOfRing() {
  SurfaceBend bend;
  bend.terms = {Vec3(0.005f, 0, -0.003f), Vec3(0, 0.1f, 0),     Vec3(-0.15f, 0.05f, 0),
                Vec3(0, 0, 0.1f),         Vec3(0, 0.6f, 0.2f),  Vec3(0.5f, 0, 0),
                Vec3(0, -0.5f, 0.1f),     Vec3(0.4f, 0, -0.3f), Vec3(0, 0.2f, 0.3f),
                Vec3(-0.2f, 0.3f, 0.1f)};
  return bend;
}

MovingPrimitive furtherBody(int kind, float dt, ShapeData& shapes) {
  const bool bent = kind + 1 == kFurtherKinds;
  if (bent) --kind;
  ContactPrimitive body;
  body.friction = 0.4f;
  body.rotation = Quat(Eigen::AngleAxisf(0.5f, Eigen::Vector3f(3, -1, 1).normalized()));
  body.kind = static_cast<PrimitiveKind>(static_cast<uint32_t>(PrimitiveKind::kTaperedCapsule) + kind);
  body.a = Vec3(-0.06f, 0, 0);
  body.b = Vec3(0.08f, 0.04f, 0.02f);
  body.radius = 0.03f;
  body.radius_b = 0.07f;
  body.extent = Vec3(0.1f, 0.05f, 0.07f);
  if (body.kind == PrimitiveKind::kConvex) {
    TriangleMesh wedge;
    wedge.positions = {{-0.1f, -0.05f, -0.07f}, {0.1f, -0.05f, -0.07f}, {0.1f, -0.05f, 0.07f},
                       {-0.1f, -0.05f, 0.07f},  {0, 0.06f, -0.05f},     {0, 0.06f, 0.05f}};
    wedge.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {3, 2, 5},
                       {0, 3, 5}, {0, 5, 4}, {1, 4, 5}, {1, 5, 2}};
    body.convex = std::make_shared<ConvexBody>(convexBody(wedge));
  }
  if (body.kind == PrimitiveKind::kField) {
    const Vec3 hole(0, 0.03f, 0);  // a ring: not convex
    const auto ring = [&](const Vec3& p) {
      const float round = std::hypot(p.x() - hole.x(), p.z() - hole.z()) - 0.08f;
      return std::hypot(round, p.y() - hole.y()) - 0.04f;
    };
    const Box box(Eigen::Vector3f(-0.12f, -0.01f, -0.12f), Eigen::Vector3f(0.12f, 0.07f, 0.12f));
    body.field = std::make_shared<DistanceField>(sampledField(ring, box, 0.005f, 0.012f));
  }
  const uint32_t data = shapes.add(body);
  auto pose = [](Vec3 position, float angle) {
    return Pose{position, Quat(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, 3).normalized()))};
  };
  MovingPrimitive placed =
      moved(body, pose({0.02f, 0.02f, 0}, 0.1f), pose({0.01f, 0.03f, 0}, -0.1f), dt, data);
  if (bent) {
    SurfaceBend begin, end = bendOfRing();
    end.middle = body.a + Vec3(0, 0.03f, 0);
    begin.terms[2] = Vec3(0.1f, -0.05f, 0);
    const MovingBend bend = bendOf(body, begin, end);
    const uint32_t at = shapes.addBend();
    shapes.setBend(at, bend);
    applyBend(placed, bend, at);
  }
  return placed;
}

Pose movedHead() {
  const Vec3 middle(0, -0.1f, 0);
  const Quat turn(Eigen::AngleAxisf(0.3f, Eigen::Vector3f(0.2f, 1, 0.1f).normalized()));
  return {middle - turn * middle + Vec3(0.02f, 0, 0), turn};
}

}  // namespace strandcast
