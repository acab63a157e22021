#include "transport/concealment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry.h"
#include "transport/body_binding.h"

namespace strandcast {
namespace {

using Rotation = Eigen::Quaterniond;
using Vector = Eigen::Vector3d;

/// `last`, moved on by `times` the screw motion (rotation about an axis in space, and translation along it)
/// from `before` to it.
Pose movedOn(const Pose& before, const Pose& last, double times) {
  constexpr double kNoTurn = 1e-6;  // rad; below it the motion is a translation
  if (before.position == last.position && before.rotation.coeffs() == last.rotation.coeffs()) return last;
  const Rotation from = before.rotation.cast<double>().normalized(),
                 to = last.rotation.cast<double>().normalized();
  const Vector place = last.position.cast<double>();
  Rotation turn = to * from.conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1;  // shortest rotation
  const Vector way = place - turn * before.position.cast<double>();
  const double angle = 2 * std::atan2(turn.vec().norm(), turn.w());
  Rotation rotation = to;
  Vector position = place + times * (place - before.position.cast<double>());
  if (angle > kNoTurn) {
    const Vector axis = turn.vec().normalized(), along = way.dot(axis) * axis, across = way - along;
    const Vector middle = 0.5 * (across + axis.cross(across) / std::tan(0.5 * angle));
    const Rotation further(Eigen::AngleAxisd(times * angle, axis));
    rotation = (further * to).normalized();
    position = further * (place - middle) + middle + times * along;
  }
  const Pose pose{position.cast<float>(), rotation.cast<float>()};
  return pose.position.allFinite() && pose.rotation.coeffs().allFinite() ? pose : last;
}

}  // namespace

void ColliderMotion::clear() {
  last_.clear();
  before_.clear();
}

void ColliderMotion::record(std::span<const PlacedCollider> placed, double time) {
  std::swap(before_, last_);
  before_time_ = last_time_;
  last_.assign(placed.begin(), placed.end());
  last_time_ = time;
}

void ColliderMotion::extrapolate(double time, std::vector<PlacedCollider>& out) const {
  out.assign(last_.begin(), last_.end());
  const double times = extrapolation(before_time_, last_time_, time);
  if (times == 0) return;
  for (PlacedCollider& placed : out) {
    const auto known = std::find_if(before_.begin(), before_.end(),
                                    [&](const PlacedCollider& before) { return before.id == placed.id; });
    if (known != before_.end()) placed.pose = movedOn(known->pose, placed.pose, times);
  }
}

void Concealment::setGroom(const StrandSet& guides) {
  offsets_ = guides.offsets;
  last_.assign(guides.vertices(), Vec3::Zero());
  before_.assign(guides.vertices(), Vec3::Zero());
  strands_.assign(guides.strands(), {});
  roots_.clear();
  for (size_t s = 0; s < guides.strands(); ++s) roots_.push_back(guides.strand(s).front());
  parts_.clear();
  places_.assign(1, HeadFrame(Pose{}));
  sums_.assign(1, {});
  colliders_.clear();
}

void Concealment::setColliders(const ColliderSet& set) {
  const std::vector<BodyPart> parts = bodyParts(set);
  const auto placeOf = [](const std::vector<uint32_t>& ids, uint32_t id) {
    return 1 + static_cast<uint32_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
  };
  std::vector<uint32_t> ids;
  for (const BodyPart& part : parts)
    if (placeOf(ids, part.collider) > ids.size()) ids.push_back(part.collider);
  if (ids == parts_) return;  // only bodies other than parts changed: ids are never reused
  const BodyBinding binding(roots_, parts);
  const std::vector<uint32_t> old_parts = std::exchange(parts_, std::move(ids));
  const std::vector<HeadFrame> old_places = places_;
  places_.resize(1, old_places[0]);
  for (const uint32_t id : parts_) {
    const uint32_t old = placeOf(old_parts, id);
    places_.push_back(old < old_places.size() ? old_places[old] : HeadFrame(Pose{}));
  }
  sums_.assign(places_.size(), {});
  for (uint32_t s = 0; s < strands_.size(); ++s) {
    Strand& strand = strands_[s];
    strand.part = binding.holds(s) ? placeOf(parts_, binding.mainCollider(s)) : 0;
    const uint32_t was = std::exchange(strand.carrier, 0);
    if (was == 0) continue;
    if (strand.part != 0 && parts_[strand.part - 1] == old_parts[was - 1])
      strand.carrier = strand.part;
    else
      attachToHead(s, old_places[was]);
  }
}

void Concealment::place(const GuideFrame& frame) {
  places_[0] = HeadFrame(frame.head);
  for (size_t i = 0; i < parts_.size(); ++i)
    for (const PlacedCollider& placed : frame.colliders)
      if (placed.id == parts_[i]) places_[1 + i] = HeadFrame(placed.pose);
}

/// Without poses of colliders, fits the poses of the parts to the received roots that they carry.
void Concealment::fitParts(GuideFrame& frame, std::span<const StrandRun> received) {
  // m^2. A regularisation: roots that are spread by more determine a part's rotation, else its extrapolated
  // rotation prevails.
  constexpr double kSpread = 1e-6;
  std::fill(sums_.begin(), sums_.end(), RootSums{});
  for (const StrandRun& run : received) {
    for (uint32_t s = run.first_strand; s < run.first_strand + run.strand_count; ++s) {
      if (strands_[s].carrier == 0) continue;
      // Uses the roots of the newest frame with known poses, not those of the last frame: errors of
      // successive fits would accumulate as drift.
      const Eigen::Vector3d local = strands_[s].root.cast<double>(),
                            world = frame.positions[offsets_[s]].cast<double>();
      RootSums& sums = sums_[strands_[s].carrier];
      ++sums.count;
      sums.local += local;
      sums.world += world;
      sums.products += world * local.transpose();
    }
  }
  for (PlacedCollider& placed : frame.colliders) {
    const auto part = std::find(parts_.begin(), parts_.end(), placed.id);
    if (part == parts_.end()) continue;
    const RootSums& sums = sums_[1 + static_cast<size_t>(part - parts_.begin())];
    if (sums.count == 0) continue;
    const Eigen::Vector3d local = sums.local / sums.count, world = sums.world / sums.count;
    const Eigen::Matrix3d moments = sums.products / sums.count - world * local.transpose() +
                                    kSpread * placed.pose.rotation.cast<double>().toRotationMatrix();
    const Quat rotation = nearestRotation(moments);  // Kabsch 1976
    const Vec3 position = (world - rotation.cast<double>() * local).cast<float>();
    if (rotation.coeffs().allFinite() && position.allFinite()) placed.pose = {position, rotation};
  }
}

/// Transfers a strand to the head, as if the carrier at `from` had been the head until now.
void Concealment::attachToHead(uint32_t strand, const HeadFrame& from) {
  for (uint32_t v = offsets_[strand]; v < offsets_[strand + 1]; ++v)
    last_[v] = places_[0].toHead(from.toWorld(last_[v]));
  strands_[strand].carrier = 0;
  strands_[strand].count = std::min(strands_[strand].count, 1u);
}

void Concealment::chooseCarrier(uint32_t strand, const Vec3& root) {
  constexpr float kFar = 1e-6f, kClearly = 4;  // kFar: m^2; kClearly: ratio of squared errors, a hysteresis
                                               // against alternating carriers
  const uint32_t part = strands_[strand].part, now = strands_[strand].carrier;
  if (part == 0) return;
  const auto off = [&](uint32_t carrier) {
    return (places_[carrier].toWorld(roots_[strand]) - root).squaredNorm();
  };
  const uint32_t other = now == 0 ? part : 0;
  const float off_now = off(now);
  if (!(off_now > kFar && off_now > kClearly * off(other))) return;
  strands_[strand].carrier = other;
  strands_[strand].count = 0;  // its motion was relative to the old carrier
}

void Concealment::record(GuideFrame& frame, std::span<const StrandRun> received) {
  const bool is_told = received.front().strand_count > 0, is_cut = frame.continuity != continuity_;
  if (is_told) {
    if (is_cut) colliders_.clear();
    continuity_ = frame.continuity;
    colliders_.record(frame.colliders, frame.simulation_time);
  } else {
    if (is_cut) colliders_.stop();
    colliders_.extrapolate(frame.simulation_time, frame.colliders);
    fitParts(frame, received);
  }
  place(frame);
  for (const StrandRun& run : received) {
    for (uint32_t s = run.first_strand; s < run.first_strand + run.strand_count; ++s) {
      const Vec3& root = frame.positions[offsets_[s]];
      if (is_told) chooseCarrier(s, root);
      Strand& strand = strands_[s];
      strand.before = strand.last;
      strand.last = frame.simulation_time;
      strand.count = strand.continuity == frame.continuity ? strand.count + 1 : 1;
      strand.continuity = frame.continuity;
      strand.frame = frame.frame;
      const HeadFrame carrier = places_[strand.carrier];
      if (is_told && strand.carrier != 0) strand.root = carrier.toHead(root);
      for (uint32_t v = offsets_[s]; v < offsets_[s + 1]; ++v) {
        before_[v] = last_[v];
        last_[v] = carrier.toHead(frame.positions[v]);
      }
    }
  }
}

void Concealment::extrapolate(uint32_t strand, const GuideFrame& frame, std::span<Vec3> out) const {
  const Strand& known = strands_[strand];
  const uint32_t first = offsets_[strand];
  const bool moves = known.count >= 2 && known.continuity == frame.continuity;
  const auto ahead =
      static_cast<float>(moves ? extrapolation(known.before, known.last, frame.simulation_time) : 0.0);
  for (size_t i = 0; i < out.size(); ++i) {
    const Vec3& last = last_[first + i];
    Vec3 moved = last + ahead * (last - before_[first + i]);
    if (i > 0) {
      // Each vertex is extrapolated linearly; then the strand is restored to its edge lengths.
      const Vec3 edge =
          moved - (last_[first + i - 1] + ahead * (last_[first + i - 1] - before_[first + i - 1]));
      const float length = edge.norm();
      const Vec3 edge_before = last - last_[first + i - 1];
      moved = out[i - 1] + (length > 0 ? Vec3(edge * (edge_before.norm() / length)) : edge_before);
    }
    out[i] = moved;
  }
  if (!std::all_of(out.begin(), out.end(), [](const Vec3& p) { return p.allFinite(); }))
    std::copy_n(last_.begin() + first, out.size(), out.begin());
}

bool Concealment::conceal(GuideFrame& frame) {
  frame.strands_concealed = 0;
  for (uint32_t s = 0; s < strands_.size(); ++s) {
    const Strand& known = strands_[s];
    if (known.count == 0) return false;
    if (known.frame == frame.frame) continue;
    const std::span<Vec3> strand(frame.positions.data() + offsets_[s], offsets_[s + 1] - offsets_[s]);
    extrapolate(s, frame, strand);
    for (Vec3& position : strand) {
      position = places_[known.carrier].toWorld(position);
      if (!position.allFinite()) return false;
    }
    ++frame.strands_concealed;
  }
  return true;
}

}  // namespace strandcast
