#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/material.h"
#include "core/strand_set.h"

namespace strandcast {

constexpr float kNoTether = 1e9f;       ///< m
constexpr float kFarFromBodies = 1e9f;  ///< m
/// m: hair that is in a body at rest, and what is joined to it, may go so much deeper. Where it may not, what
/// was pulled along or out of the skin is caught in another place and trembles there.
constexpr float kSkinDepth = 1e-3f;

/// What does not change while strands move: the rest shape and who is pinned. Natural order (see StrandSet).
struct StrandModel {
  std::vector<uint32_t> offsets{0};  ///< strands + 1
  std::vector<Vec3> rest_local;      ///< per vertex, metres, in the strand's root frame (root at the origin)
  std::vector<uint8_t> pinned;       ///< per vertex, 1 = it is, as every root; empty = only the roots are
  std::vector<Pose> rest_roots;      ///< per strand, in the groom's frame; z is the rest tangent at the root

  // The strand as an elastic rod. Entry i of a strand is its vertex i, edge (i, i + 1) or joint before edge
  // i; the last edge and joint entry is unused. Masses and stiffnesses are divided by `reference_mass` of the
  // strand.
  std::vector<Quat> rest_frames;  ///< per edge, material frame in the root frame; z is the edge's direction
  std::vector<Vec3>
      rest_strain;           ///< per joint, bending x y and twist z at rest, in the frame before the joint
  std::vector<float> bend;   ///< per joint, B / cell length, m^2/s^2; joint 0 has half a cell
  std::vector<float> twist;  ///< per joint, C / cell length, m^2/s^2
  std::vector<float> mass;   ///< per vertex, about 1
  std::vector<float> rest_tension;    ///< per edge, m/s^2: what its rest shape is held with
  std::vector<float> reference_mass;  ///< per strand, kg: its mean vertex mass

  // Grooming, see Material: tethers, and factors of what Parameters has for all hair. All empty where there
  // is no tether and every factor is 1.
  std::vector<float> air_drag_scale, goal_scale;     ///< per vertex
  std::vector<float> damping_scale, friction_scale;  ///< per strand
  std::vector<float> tether;                         ///< per vertex, m from the root; kNoTether = none
  /// Per joint, of damping_scale, and per vertex, of friction_scale. Both empty where they are 1 everywhere;
  /// else the others are there too.
  std::vector<float> damping_along, friction_along;

  /// Per vertex, m: how near the bodies that it grows on may come, negative inside; every body may come as
  /// near where that is less than the hair's radius. As near as at rest, but of segments that are in or
  /// through the skin at rest kSkinDepth nearer, so that they find back. -kFarFromBodies: no body holds it.
  /// Empty = all are kFarFromBodies.
  std::vector<float> rest_distance;

  // What pinned vertices move with. A bone's pose is its motion since the groom's rest, as the head's is.
  std::vector<std::string> bones{"head"};  ///< at least the head, which is the first
  std::vector<uint16_t> root_bones;        ///< per strand, of its root frame; empty = the head
  std::vector<uint16_t> pin_bones;         ///< per vertex, where pinned; empty = all as their root

  uint16_t rootBone(size_t strand) const { return root_bones.empty() ? 0 : root_bones[strand]; }
  bool isPinned(size_t strand, uint32_t vertex) const {
    return vertex == offsets[strand] || (!pinned.empty() && pinned[vertex] != 0);
  }
  /// Whether a vertex is pinned to another bone than its root frame.
  bool isBonePinned(size_t strand, uint32_t vertex) const {
    return !pin_bones.empty() && vertex > offsets[strand] && isPinned(strand, vertex) &&
           pin_bones[vertex] != rootBone(strand);
  }
  /// At rest, m, in the groom's frame.
  Vec3 restPosition(size_t strand, uint32_t vertex) const {
    return rest_roots[strand].apply(rest_local[vertex]);
  }
  /// Where there are factors: that of the damping time at the joint before the edge that begins at a vertex,
  /// and that of friction at a vertex.
  float dampingFactor(size_t strand, uint32_t vertex) const {
    return damping_scale[strand] * (damping_along.empty() ? 1 : damping_along[vertex]);
  }
  float frictionFactor(size_t strand, uint32_t vertex) const {
    return friction_scale[strand] * (friction_along.empty() ? 1 : friction_along[vertex]);
  }
  /// Whether a factor of the strand is not 1.
  bool hasFactors(size_t strand) const;
  bool hasTethers(size_t strand) const {
    return !tether.empty() && tether[offsets[strand + 1] - 1] < kNoTether;
  }
  size_t strands() const { return offsets.size() - 1; }
  size_t vertices() const { return rest_local.size(); }
  size_t verticesOf(size_t strand) const { return offsets[strand + 1] - offsets[strand]; }
};

/// How a strand is bent at rest: bendsUnevenly() and isSharp() of kernels/rod.h.
struct RestBends {
  bool uneven, sharp;
};
RestBends restBends(const StrandModel& model, size_t strand);
/// By how much of their mean the edges of a strand may differ and still count as of one length, and masses of
/// its vertices as one: points in float do not tell more, so far from the origin.
float evenTolerance(const StrandModel& model, size_t strand);
/// Whether a strand has a free vertex before one that is pinned.
bool hangsBetweenPins(const StrandModel& model, size_t strand);

/// m^2/s^2, bend and twist at most, 100 times that of the shortest fur: a strand as stiff as this all along
/// steps to finite numbers in float at any time step.
constexpr float kStiffestJoint = 1e9f;

/// What moves. Natural order. `frames`, `tensions` and `contacts` are the rod's; they may be empty where only
/// the others matter: a step then starts from untwisted frames, no tension and no contact.
struct StrandState {
  std::vector<Vec3> positions;   ///< per vertex, metres, world
  std::vector<Vec3> velocities;  ///< per vertex, m/s, world
  /// Per edge (i, i + 1), world; z is the edge's direction. Of the rod, whose elastic energy in J is, per
  /// joint, reference_mass / 2 x (bend |k_xy - rest k_xy|^2 + twist (k_z - rest k_z)^2), k as rest_strain: in
  /// the frame before the joint, 2 tan(angle / 2) along the axis of the turn to the frame after it.
  std::vector<Quat> frames;
  std::vector<float>
      tensions;  ///< per edge, tension / reference mass, m/s^2; what the next substep starts from
  std::vector<Vec3> contacts;  ///< per vertex, force of the bodies / reference mass, m/s^2, world; likewise
};

/// Builds a model from rest strands. Strands must have 2 to 128 vertices within kFarthestPose of the origin
/// and edges of positive length (groom/ cleans them); throws Error naming the strand otherwise, and as
/// checkStrandSet() and checkMaterial(). It takes edges as they are: a strand with one that is shorter than a
/// tenth of the strand's mean edge trembles for ever under `rod` (cleanStrands() of groom/clean.h merges such
/// vertices).
/// `materials` by StrandSet::parts, the last one for all further parts; at least one.
StrandModel makeStrandModel(const StrandSet& rest, const std::vector<Material>& materials = {Material{}});

/// Throws Error, naming `where` and the array, when arrays of a model do not fit each other, are missing, or
/// have a number that is not finite or out of range, or where only some of the grooming's are given. What
/// makeStrandModel() gives passes, but where bend or twist comes out above kStiffestJoint.
void checkModel(const StrandModel& model, const std::string& where);

/// The bone of this name, which is added where there is none. Throws Error, naming it, on more than 65,535
/// beside the head.
uint16_t addBone(StrandModel& model, const std::string& bone);

/// Pins to a bone what of a strand lies from `from` to `to`, parts of its arc length from the root (0) to the
/// tip (1); at 0 its root frame too. Throws Error, naming the bone, on an unknown bone or strand, a range
/// that is none, or in which no vertex lies. To be called before makeSagFree.
void pinToBone(StrandModel& model, size_t strand, float from, float to, uint16_t bone);
/// The same with addBone().
void pinToBone(StrandModel& model, size_t strand, float from, float to, const std::string& bone);

/// The rest shape carried rigidly by its roots (one per strand, else Error), at rest.
StrandState restState(const StrandModel& model, const std::vector<Pose>& roots);

/// Of every strand at rest, m.
std::vector<float> strandLengths(const StrandModel& model);

/// All vertices at rest, m, in the groom's frame.
Box restBox(const StrandModel& model);

/// 64-bit FNV-1a over the bytes of positions and velocities: equal motion, equal hashes.
uint64_t stateHash(const StrandState& state);

constexpr uint32_t kMinVerticesPerStrand = 2;
constexpr uint32_t kMaxVerticesPerStrand = 128;

}  // namespace strandcast
