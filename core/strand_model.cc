#include "core/strand_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace strandcast {
namespace {

void checkStrand(std::span<const Vec3> points, size_t strand) {
  const std::string where = fmt::format("strand {}", strand);
  if (points.size() < kMinVerticesPerStrand || points.size() > kMaxVerticesPerStrand)
    throw Error(fmt::format("a strand has {} vertices, the solver takes {} to {}", points.size(), kMinVerticesPerStrand,
                            kMaxVerticesPerStrand),
                where, "resample the groom (--vertices)");
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw Error("a vertex is not a finite point", where, "clean the groom");
    if (i > 0 && !((points[i] - points[i - 1]).norm() > 0))
      throw Error("two neighbouring vertices coincide", where, "clean the groom");
  }
}

}  // namespace

StrandModel makeStrandModel(const StrandSet& rest) {
  StrandModel model;
  model.offsets = rest.offsets;
  model.rest_local.resize(rest.vertices());
  model.inverse_mass.resize(rest.vertices());
  model.rest_roots.resize(rest.strands());
  for (size_t s = 0; s < rest.strands(); ++s) {
    const std::span<const Vec3> points = rest.strand(s);
    checkStrand(points, s);
    const Vec3 tangent = (points[1] - points[0]).normalized();
    Pose& root = model.rest_roots[s];
    root.position = points[0];
    root.rotation = shortestRotation<float>(Eigen::Vector3f::UnitZ(), tangent).normalized();
    const Pose to_local = root.inverse();
    for (size_t i = 0; i < points.size(); ++i) {
      model.rest_local[rest.offsets[s] + i] = i == 0 ? Vec3(Vec3::Zero()) : to_local.apply(points[i]);
      model.inverse_mass[rest.offsets[s] + i] = rest.isPinned(s, i) ? 0.0f : 1.0f;
    }
  }
  return model;
}

StrandState restState(const StrandModel& model, const std::vector<Pose>& roots) {
  StrandState state;
  state.positions.resize(model.vertices());
  state.velocities.assign(model.vertices(), Vec3::Zero());
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      state.positions[v] = roots[s].apply(model.rest_local[v]);
  return state;
}

uint64_t stateHash(const StrandState& state) {
  uint64_t hash = 14695981039346656037ull;
  for (const std::vector<Vec3>* plane : {&state.positions, &state.velocities}) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(plane->data());
    for (size_t i = 0; i < plane->size() * sizeof(Vec3); ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
  }
  return hash;
}

}  // namespace strandcast
