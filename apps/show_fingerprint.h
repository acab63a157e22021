#pragma once
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/show.h"

namespace strandcast {

/// What daemons that share a groom have to have in common, as entries of a show: strands, materials, solver,
/// body, colliders and motion of the scene. What commands steer is not in it.
std::vector<ShowEntry> fingerprintOf(const Scene& scene, const Settings& settings);
/// What of `other` is not as in `own`, for people: "strands (30, not 20)". Empty where all is alike.
std::string differenceOf(const std::vector<ShowEntry>& own, const std::vector<ShowEntry>& other);

}  // namespace strandcast
