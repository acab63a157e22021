#include "gpu_compute/step_input.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/backend.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
namespace kernels::f32 {
#include "core/body_surface.inl"
}  // namespace kernels::f32
}  // namespace strandcast

namespace strandcast::gpu {
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
// kMotionTolerance of shaders/step_input.glsl.
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

Settings settingsOf(const StepInput& input, const StrandModel& model) {
  const Parameters& p = *input.parameters;
  const double h = static_cast<double>(p.time_step) / p.substeps;
  Settings s{};
  for (int c = 0; c < 3; ++c) {
    s.gravity[c] = p.gravity[c];
    s.wind[c] = p.wind[c];
  }
  const DragStep drag(p.air_drag, h);
  s.keep = static_cast<float>(drag.keep);
  s.time2 = static_cast<float>(drag.time2);
  s.substep = static_cast<float>(h);
  s.per_substep = static_cast<float>(1 / h);
  s.strength_root = static_cast<float>(1 - std::exp(-p.shape_rate * h / p.iterations));
  s.strength_tip = static_cast<float>(1 - std::exp(-p.shape_rate_tip * h / p.iterations));
  s.damping_time = p.damping_time;
  s.hair_radius = p.hair_radius;
  s.air_drag = p.air_drag;
  s.goal_rate = p.goal_rate;
  s.substeps = static_cast<uint32_t>(p.substeps);
  s.iterations = static_cast<uint32_t>(p.iterations);
  s.body_count = static_cast<uint32_t>(input.primitives.size());
  s.strand_count = static_cast<uint32_t>(model.strands());
  s.bone_count = static_cast<uint32_t>(model.bones.size());
  s.neighbourhoods = input.near != nullptr ? static_cast<uint32_t>(input.near->offsets.size()) - 1 : 0;
  return s;
}

namespace {

template <size_t n>
bool same(const float (&a)[n], const float (&b)[n]) {
  return std::equal(a, a + n, b);
}

bool continues(const MovingPrimitive& before, const MovingPrimitive& now) {
  // The bend of a field, and so its bounding radius, may change between steps.
  const bool bends = now.kind == static_cast<uint32_t>(PrimitiveKind::kField);
  return before.kind == now.kind && (bends || (before.radius == now.radius && before.extra == now.extra)) &&
         before.radius_b == now.radius_b && before.data == now.data && same(before.extent, now.extent) &&
         same(before.a_end, now.a_begin) && same(before.b_end, now.b_begin) &&
         same(before.rotation_end, now.rotation_begin);
}

}  // namespace

bool PreviousBodies::isContinuation(const StepInput& input) const {
  const bool shaped = input.shapes == nullptr || input.shapes->revision == shapes_revision_;
  const bool listed = input.near != nullptr;
  return shaped && input.parameters->hair_radius == hair_radius_ &&
         std::ranges::equal(bodies_, input.primitives, continues) && listed == listed_ &&
         (!listed || (input.near->offsets == near_.offsets && input.near->bodies == near_.bodies));
}

bool PreviousBodies::matchesNext(const StepInput& input) {
  const bool holds = isContinuation(input);
  bodies_.assign(input.primitives.begin(), input.primitives.end());
  listed_ = input.near != nullptr;
  if (listed_) near_ = *input.near;
  if (input.shapes != nullptr) shapes_revision_ = input.shapes->revision;
  hair_radius_ = input.parameters->hair_radius;
  return holds;
}

}  // namespace strandcast::gpu
