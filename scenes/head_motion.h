#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "groom/skeleton.h"

namespace strandcast {

/// Where the head is at a time in seconds since the start, relative to its rest pose: identity at rest.
/// Starts smoothly from rest. Procedural motions turn about the neck joint `pivot` (metres, groom frame).
using HeadMotion = std::function<Pose(double seconds)>;

/// "still", "nod", "shake", "turn", or a combination such as "nod+turn". Error otherwise.
HeadMotion proceduralMotion(const std::string& name, const Vec3& pivot);

/// What a head motion by a clip is made with.
struct ClipMotionOptions {
  float unit_meters = 0;               ///< metres per unit of the clip, 0 to 1000; 0 = found, see unitOf()
  std::string joint;                   ///< that is followed; empty = the first whose name contains "head"
  const Skeleton* skeleton = nullptr;  ///< of the body; joints of the clip's names tell its unit and axes
};

/// The head of a BVH clip, relative to its first frame, looped: travel is taken out and the end returns to
/// the start. Z-up clips are turned to Y up. What there is to say of file, unit and travel is added to
/// `notes` and `warnings`, a line each, where they are not null. Throws Error on a file that cannot be read
/// and on an unknown joint.
HeadMotion bvhMotion(const std::filesystem::path& file, const Vec3& pivot,
                     const ClipMotionOptions& options = {}, std::vector<std::string>* notes = nullptr,
                     std::vector<std::string>* warnings = nullptr);

constexpr double kTravelWorthSaying = 1e-2;  ///< m
/// "... travels 1.2 m from its first frame to its last (joint 'hips'): this is taken out": of a clip.
std::string travelText(const std::string& clip, const std::string& joint, double meters);

/// `motion` about `pivot` until `end` seconds, brought back to the rest pose within the last half second of
/// them with no jump in velocity; still from then on.
HeadMotion endingAt(HeadMotion motion, double end, const Vec3& pivot);

/// Whether a motion, of a head or a body, is a BVH clip: a path ending in .bvh, in any case.
bool isBvh(const std::string& description);

/// `description` is a procedural name or isBvh(): then as bvhMotion().
HeadMotion headMotion(const std::string& description, const Vec3& pivot,
                      const ClipMotionOptions& options = {}, std::vector<std::string>* notes = nullptr,
                      std::vector<std::string>* warnings = nullptr);

}  // namespace strandcast
