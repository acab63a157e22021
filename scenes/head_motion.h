#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "core/geometry.h"

namespace strandcast {

/// Where the head is at a time in seconds since the start, relative to its rest pose: identity at rest.
/// Starts smoothly from rest. Procedural motions turn about the neck joint `pivot` (metres, groom frame).
using HeadMotion = std::function<Pose(double seconds)>;

/// "still", "nod", "shake", "turn", or a combination such as "nod+turn". Error otherwise.
HeadMotion proceduralMotion(const std::string& name, const Vec3& pivot);

/// The head of a BVH clip, relative to its first frame, looped: travel is taken out and the end returns to
/// the start. `unit_meters` 0 = guess from the size of the skeleton; Z-up clips are turned to Y up. `joint`
/// names the joint to follow, by default the first whose name contains "head". Throws Error on a file that
/// cannot be read.
HeadMotion bvhMotion(const std::filesystem::path& file, float unit_meters, const Vec3& pivot,
                     const std::string& joint = "");

/// `motion` about `pivot` until `end` seconds, brought back to the rest pose within the last half second of
/// them with no jump in velocity; still from then on.
HeadMotion endingAt(HeadMotion motion, double end, const Vec3& pivot);

/// `description` is a procedural name or a path ending in .bvh.
HeadMotion headMotion(const std::string& description, const Vec3& pivot);

}  // namespace strandcast
