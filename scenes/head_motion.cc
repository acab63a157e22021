#include "scenes/head_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/bvh.h"
#include "io/bvh_skeleton.h"
#include "io/file_bytes.h"
#include "io/file_report.h"

namespace strandcast {
namespace {

constexpr double kEnd = 0.5;  // s, duration of the return to rest

struct Swing {
  const char* name;
  Vec3 axis;
  double degrees, hertz;
};
const Swing kSwings[] = {{"still", Vec3::UnitY(), 0, 0},
                         {"nod", Vec3::UnitX(), 15, 0.8},
                         {"shake", Vec3::UnitY(), 35, 1.0},
                         {"turn", Vec3::UnitY(), 45, 0.2}};

Quat swung(const Swing& swing, double seconds) {
  const double turn = 2 * std::numbers::pi * swing.hertz * seconds;
  const double angle =
      swing.degrees * std::numbers::pi / 180 * ease(seconds / kStartSeconds) * std::sin(turn);
  return Quat(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f(swing.axis)));
}

// A rotation about `pivot`, followed by a translation.
Pose about(const Vec3& pivot, const Quat& rotation, const Vec3& shift) {
  return {pivot + shift - rotation * pivot, rotation};
}

// Motion of a joint, sampled per frame relative to the first frame and made to loop.
struct Track {
  double frame_time = 0;
  std::vector<Quat> rotations;
  std::vector<Vec3> shifts;  // m

  // Catmull-Rom interpolation around the loop. Its velocity is continuous: jumps would shake the hair.
  void at(double seconds, Quat& rotation, Vec3& shift) const {
    const auto n = static_cast<double>(rotations.size());
    double frame = std::fmod(std::max(seconds, 0.0) / frame_time, n);
    if (!(frame >= 0 && frame < n)) frame = 0;
    const auto i = static_cast<size_t>(frame);
    const auto t = static_cast<float>(frame - static_cast<double>(i));
    const float weights[4] = {t * (-0.5f + t * (1 - 0.5f * t)), 1 + t * t * (1.5f * t - 2.5f),
                              t * (0.5f + t * (2 - 1.5f * t)), t * t * (0.5f * t - 0.5f)};
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    shift = Vec3::Zero();
    for (size_t k = 0; k < 4; ++k) {
      const size_t j = (i + rotations.size() * 2 + k - 1) % rotations.size();
      const float side = rotations[j].dot(rotations[i]) < 0 ? -1.0f : 1.0f;
      sum += weights[k] * side * Eigen::Vector4f(rotations[j].coeffs());
      shift += weights[k] * shifts[j];
    }
    rotation.coeffs() = sum.normalized();
  }
};

Track trackOf(const BvhClip& clip, size_t joint, float unit_meters, const Quat& up) {
  const Pose first = clip.pose(joint, 0);
  const Pose last = clip.pose(joint, clip.frames - 1);
  // The last frame coincides with the first of the next round.
  const size_t period = std::max<size_t>(clip.frames - 1, 1);
  Track track;
  track.frame_time = clip.frame_time;
  const double blend = std::min(kLoopBlend, 0.5 * clip.frame_time * static_cast<double>(period));
  for (size_t f = 0; f < period; ++f) {
    const Pose pose = clip.pose(joint, f);
    const float share = static_cast<float>(f) / static_cast<float>(period);
    const Vec3 travelled = pose.position - first.position - share * (last.position - first.position);
    const double left = clip.frame_time * static_cast<double>(period - f);
    // Rotations return to those of the first frame.
    const auto back = static_cast<float>(1 - ease(left / blend));
    const Quat turned = (pose.rotation * first.rotation.conjugate()).normalized();
    track.rotations.push_back(up * turned.slerp(back, Quat::Identity()) * up.conjugate());
    track.shifts.push_back(up * travelled * unit_meters);
  }
  return track;
}

}  // namespace

HeadMotion proceduralMotion(const std::string& name, const Vec3& pivot) {
  std::vector<Swing> chosen;
  for (size_t begin = 0; begin <= name.size();) {
    const size_t end = std::min(name.find('+', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    const auto* found =
        std::find_if(std::begin(kSwings), std::end(kSwings), [&](const Swing& s) { return part == s.name; });
    if (found == std::end(kSwings))
      throw Error("unknown motion", "'" + part + "'",
                  "choose still, nod, shake, turn, some of them joined by '+'; a daemon takes a .bvh file at "
                  "its start");
    chosen.push_back(*found);
    begin = end + 1;
  }
  return [chosen, pivot](double seconds) {
    Quat rotation = Quat::Identity();
    for (const Swing& swing : chosen) rotation = rotation * swung(swing, seconds);
    return about(pivot, rotation.normalized(), Vec3::Zero());
  };
}

HeadMotion bvhMotion(const std::filesystem::path& file, const Vec3& pivot, const ClipMotionOptions& options,
                     std::vector<std::string>* notes, std::vector<std::string>* warnings) {
  if (!(options.unit_meters >= 0 && options.unit_meters <= 1000))
    throw Error("unit is out of range", std::to_string(options.unit_meters),
                "give metres per unit, or 0 to guess");
  const BvhClip clip = readBvh(file);
  const int found = clip.find(options.joint);
  if (found < 0)
    throw Error("no such joint",
                file.string() + ", " + (options.joint.empty() ? "a name with 'head'" : options.joint),
                "name a joint of the clip");
  const auto head = static_cast<size_t>(found);
  const BvhMatch match(clip, options.skeleton != nullptr ? *options.skeleton : Skeleton());
  BvhUnit unit = unitOf(clip, &match, options.unit_meters);
  FileReport report = clip.report;
  report.warnings.insert(report.warnings.end(), unit.warnings.begin(), unit.warnings.end());
  std::vector<std::string> told, doubts;
  appendReport(file, report, told, doubts);
  for (const std::string& note : unit.notes) told.push_back(file.string() + ": " + note);
  const Vec3 way = clip.pose(head, clip.frames - 1).position - clip.pose(head, 0).position;
  if (const auto travel = static_cast<double>(way.norm() * unit.meters); travel > kNotableTravel)
    told.push_back(travelText(file.string(), clip.joints[head].name, travel));
  if (notes != nullptr) notes->insert(notes->end(), told.begin(), told.end());
  if (warnings != nullptr) warnings->insert(warnings->end(), doubts.begin(), doubts.end());
  const auto track =
      std::make_shared<const Track>(trackOf(clip, head, unit.meters, match.upright(clip, head)));
  return [track, pivot](double seconds) {
    Quat rotation;
    Vec3 shift;
    track->at(kStartSeconds * easeIntegral(seconds / kStartSeconds), rotation,
              shift);  // the time itself accelerates smoothly from rest
    return about(pivot, rotation, shift);
  };
}

std::string travelText(const std::string& clip, const std::string& joint, double meters) {
  return fmt::format(
      "{}: '{}' travels {:.3g} m from the first frame to the last, which is taken out to play it in place",
      clip, printable(joint), meters);
}

HeadMotion endingAt(HeadMotion motion, double end, const Vec3& pivot) {
  return [motion = std::move(motion), end, pivot](double seconds) {
    if (seconds >= end) return Pose{};
    const auto back = static_cast<float>(ease((seconds - end + kEnd) / kEnd));
    const Pose pose = motion(seconds);
    return about(pivot, pose.rotation.slerp(back, Quat::Identity()),
                 (1 - back) * (pose.apply(pivot) - pivot));
  };
}

bool isBvh(const std::string& description) { return lowerExtension(description) == ".bvh"; }

HeadMotion headMotion(const std::string& description, const Vec3& pivot, const ClipMotionOptions& options,
                      std::vector<std::string>* notes, std::vector<std::string>* warnings) {
  if (isBvh(description)) return bvhMotion(description, pivot, options, notes, warnings);
  return proceduralMotion(description, pivot);
}

}  // namespace strandcast
