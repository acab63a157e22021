#pragma once
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "core/strand_set.h"

namespace strandcast {

/// What does not change while strands move: the rest shape and who is pinned. Natural order (see StrandSet).
struct StrandModel {
  std::vector<uint32_t> offsets{0};    ///< strands + 1
  std::vector<Vec3> rest_local;        ///< per vertex, metres, in the strand's root frame (root at the origin)
  std::vector<float> inverse_mass;     ///< per vertex, relative: 0 pinned to the root frame, 1 free
  std::vector<Pose> rest_roots;        ///< per strand, in the groom's frame; z is the rest tangent at the root

  size_t strands() const { return offsets.size() - 1; }
  size_t vertices() const { return rest_local.size(); }
  size_t verticesOf(size_t strand) const { return offsets[strand + 1] - offsets[strand]; }
};

/// What moves. Natural order.
struct StrandState {
  std::vector<Vec3> positions;   ///< per vertex, metres, world
  std::vector<Vec3> velocities;  ///< per vertex, m/s, world
};

/// Builds a model from rest strands. Strands must have 2 to 128 vertices and edges of positive length
/// (groom/ cleans them); throws Error naming the strand otherwise.
StrandModel makeStrandModel(const StrandSet& rest);

/// The rest shape carried rigidly by its roots, at rest.
StrandState restState(const StrandModel& model, const std::vector<Pose>& roots);

/// 64-bit FNV-1a over the bytes of positions and velocities: equal states, equal hashes.
uint64_t stateHash(const StrandState& state);

constexpr uint32_t kMinVerticesPerStrand = 2;
constexpr uint32_t kMaxVerticesPerStrand = 128;

}  // namespace strandcast
