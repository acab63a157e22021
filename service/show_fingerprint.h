#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "options/settings.h"
#include "transport/show.h"

namespace strandcast {

/// What daemons that share a groom must have in common, as entries of a show: strands, materials, solver,
/// body, colliders and motion of the scene, and mesh hashes by collider name. State that commands change is
/// not included.
std::vector<ShowEntry> fingerprintOf(const Scene& scene, const Settings& settings);
/// Entries of `own` that differ in `other`, as text: "strands (30 here, 20 there)". Empty where all are
/// equal. A mesh hash that only one of them has is no difference, because older daemons send none.
std::string differenceOf(const std::vector<ShowEntry>& own, const std::vector<ShowEntry>& other);

/// The mesh hash of a collider made by command, as an entry of a show; `mesh_hash` as in ColliderMaker::Made.
ShowEntry meshEntry(const std::string& collider, uint64_t mesh_hash);
/// The mesh hash of this collider in a show; 0 where it has none, as with older daemons.
uint64_t meshHashIn(const std::vector<ShowEntry>& show, const std::string& collider);

}  // namespace strandcast
