#include "gpu_compute/previous_bodies.h"

#include <algorithm>

namespace strandcast::gpu {
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
