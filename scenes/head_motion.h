#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/skeleton.h"

namespace strandcast {

/// Smooth step from 0 to 1 over [0, 1] whose first two derivatives vanish at both ends; and its integral from
/// 0.
inline double ease(double u) { return u <= 0 ? 0 : u >= 1 ? 1 : u * u * u * (10 + u * (6 * u - 15)); }
inline double easeIntegral(double u) {
  return u <= 0 ? 0 : u >= 1 ? u - 0.5 : u * u * u * u * (2.5 + u * (u - 3));
}

constexpr double kStartSeconds = 0.5;  ///< s, time over which a motion starts from rest
constexpr double kLoopBlend = 0.25;    ///< s, time over which the end of a clip returns to its start

/// Pose of the head relative to rest, at a time in seconds since the start; the identity at rest. Motions
/// start smoothly from rest. Procedural motions rotate about the neck joint `pivot` (metres, frame of the
/// groom).
using HeadMotion = std::function<Pose(double seconds)>;

/// Motion by name: "still", "nod", "shake", "turn", or a combination such as "nod+turn". Error otherwise.
HeadMotion proceduralMotion(const std::string& name, const Vec3& pivot);

/// Options of a head motion by a clip.
struct ClipMotionOptions {
  float unit_meters = 0;  ///< metres per unit of the clip, 0 to 1000; 0: deduced, see unitOf()
  std::string joint;      ///< the joint to follow; empty: the first whose name contains "head"
  /// Of the body; joints of equal names determine the clip's unit and axes.
  const Skeleton* skeleton = nullptr;
};

/// Motion of the head joint of a BVH clip, relative to the first frame, looped. Travel is removed, and the
/// end returns to the start. Z-up clips are rotated to Y up. Remarks on file, unit and travel are appended to
/// `notes` and `warnings`, one line each, unless these are null. Throws Error on a file that cannot be read
/// and on an unknown joint.
HeadMotion bvhMotion(const std::filesystem::path& file, const Vec3& pivot,
                     const ClipMotionOptions& options = {}, std::vector<std::string>* notes = nullptr,
                     std::vector<std::string>* warnings = nullptr);

constexpr double kNotableTravel = 1e-2;  ///< m, travel that is mentioned in a note
/// Note that the travel of a clip is removed: "CLIP: 'hips' travels 1.2 m from the first frame to the last,
/// which ...".
std::string travelText(const std::string& clip, const std::string& joint, double meters);

/// `motion` about `pivot` until `end` seconds, brought back to the rest pose within the last half second with
/// continuous velocity; at rest from then on.
HeadMotion endingAt(HeadMotion motion, double end, const Vec3& pivot);

/// Whether a motion, of a head or a body, is a BVH clip: a path that ends in .bvh, ignoring case.
bool isBvh(const std::string& description);

/// `description`: the name of a procedural motion, or the path of a BVH clip (isBvh()), which is then read by
/// bvhMotion().
HeadMotion headMotion(const std::string& description, const Vec3& pivot,
                      const ClipMotionOptions& options = {}, std::vector<std::string>* notes = nullptr,
                      std::vector<std::string>* warnings = nullptr);

}  // namespace strandcast
