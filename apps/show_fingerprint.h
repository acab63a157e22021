#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/show.h"

namespace strandcast {

/// What daemons that share a groom have to have in common, as entries of a show: strands, materials, solver,
/// body, colliders and motion of the scene, and the meshes of its colliders by name. What commands steer is
/// not in it.
std::vector<ShowEntry> fingerprintOf(const Scene& scene, const Settings& settings);
/// What of `other` is not as in `own`, for people: "strands (30, not 20)". Empty where all is alike.
/// A mesh of a collider that only one of them tells of is no difference: daemons of before tell none.
std::string differenceOf(const std::vector<ShowEntry>& own, const std::vector<ShowEntry>& other);

/// The mesh that a command had a collider made of, as an entry of a show; `mesh_hash` is of
/// ColliderMaker::Made.
ShowEntry meshEntry(const std::string& collider, uint64_t mesh_hash);
/// The `mesh_hash` that a show tells of this collider; 0 where it tells none, as daemons of before do.
uint64_t meshHashIn(const std::vector<ShowEntry>& show, const std::string& collider);

}  // namespace strandcast
