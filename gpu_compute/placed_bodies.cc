#include "gpu_compute/placed_bodies.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "kernels/scalar_float.h"

namespace strandcast {
namespace kernels::f32 {
#include "core/body_surface.inl"
}  // namespace kernels::f32

namespace gpu {
namespace {

constexpr float kEverywhere = 1e18f;  // m; its square is still finite in float

template <class To, class From, size_t n>
void put(To (&to)[n], const From (&from)[n]) {
  std::copy(from, from + n, to);
}

Eigen::Quaternionf turnOf(const MovingPrimitive& body) {
  return Eigen::Quaternionf(body.rotation_end) * Eigen::Quaternionf(body.rotation_begin).conjugate();
}

// Whether the motion of both bodies in the step, of points within some metres of them, differs by at most
// kAlike of shaders/step_input.glsl.
bool movesAlike(const MovingPrimitive& p, const MovingPrimitive& q) {
  if (isBent(p) || isBent(q)) return false;
  constexpr float kAlikePlace = 2e-5f, kAlikeTurn = 2e-5f;  // m, radians
  const Eigen::Quaternionf turn = turnOf(p);
  const Vec3 carried = Vec3(p.a_end) + turn * (Vec3(q.a_begin) - Vec3(p.a_begin));
  return (carried - Vec3(q.a_end)).norm() < kAlikePlace && turn.angularDistance(turnOf(q)) < kAlikeTurn;
}

uint32_t leaderOf(std::span<const MovingPrimitive> bodies, uint32_t body) {
  uint32_t leader = 0;
  while (!movesAlike(bodies[leader], bodies[body]) && leader != body) ++leader;
  return leader;
}

}  // namespace

PlacedBody placedBody(const MovingPrimitive& primitive, double time, double part, double seconds,
                      float hair_radius) {
  const kernels::f32::SubstepBody at =
      kernels::f32::bodyAt(primitive, nullptr, time, part, seconds, hair_radius);
  PlacedBody body{};
  put(body.middle, at.middle);
  body.ball = at.kind == PrimitiveKind::kPlane ? kEverywhere : at.ball;
  put(body.a, at.a);
  body.radius = at.radius;
  put(body.b, at.b);
  body.radius_b = at.radius_b;
  put(body.a_motion, at.a_motion);
  body.friction = at.friction;
  put(body.turn, at.turn);
  body.kind = primitive.kind;
  if (at.kind >= PrimitiveKind::kEllipsoid) put(body.rotation, at.rotation);
  put(body.extent, at.extent);
  body.data = at.data;
  body.extra = at.extra;
  body.time = at.time;
  return body;
}

void Leaders::reserve(size_t bodies) {
  leaders_.reserve(bodies);
  listed_.reserve(bodies);
}

void Leaders::groupByMotion(std::span<const MovingPrimitive> bodies) {
  leaders_.clear();
  for (uint32_t i = 0; i < bodies.size(); ++i) leaders_.push_back(leaderOf(bodies, i));
}

void Leaders::writeLists(const NearBodyLists& near, uint32_t* out) {
  out = std::copy(near.offsets.begin(), near.offsets.end(), out);
  uint32_t* starts = std::copy(near.bodies.begin(), near.bodies.end(), out);
  uint32_t* const lists = starts + near.offsets.size();
  listed_.assign(leaders_.size(), 0);
  uint32_t count = 0;
  *starts++ = count;
  for (size_t list = 1; list < near.offsets.size(); ++list) {
    for (const uint32_t body : near.of(list - 1)) {
      const uint32_t leader = leaders_[body];
      if (std::exchange(listed_[leader], list) != list) lists[count++] = leader;
    }
    *starts++ = count;
  }
}

void placeBodies(const StepInput& input, const Leaders& leaders, PlacedBody* out) {
  const Parameters& p = *input.parameters;
  const double part = 1.0 / p.substeps, seconds = static_cast<double>(p.time_step) / p.substeps;
  const auto bodies = static_cast<uint32_t>(input.primitives.size());
  for (uint32_t i = 0; i < bodies; ++i) {
    const MovingPrimitive& primitive = input.primitives[i];
    MovingBend bend{};
    if (isBent(primitive)) std::memcpy(&bend, input.shapes->words.data() + primitive.extra, sizeof bend);
    for (int substep = 0; substep < p.substeps; ++substep) {
      PlacedBody& placed = out[static_cast<size_t>(substep) * bodies + i];
      placed = placedBody(primitive, (substep + 1) * part, part, seconds, p.hair_radius);
      placed.leader = leaders.of(i);
      placed.bend_shift = bend.shift * static_cast<float>(part);
    }
  }
}

}  // namespace gpu
}  // namespace strandcast
