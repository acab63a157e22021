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
/// Extra depth, m, that contact allows to vertices inside a body at rest, and to their neighbours. Without
/// it, hair that was pulled along or out of the skin is caught in another position and trembles there.
constexpr float kSkinDepth = 1e-3f;

/// What does not change while strands move: rest shape, masses, stiffnesses, grooming factors and pins.
/// Natural order (see StrandSet).
struct StrandModel {
  std::vector<uint32_t> offsets{0};  ///< strands + 1
  std::vector<Vec3> rest_local;      ///< per vertex, m, in the strand's root frame (root at the origin)
  std::vector<uint8_t> pinned;       ///< per vertex, 1 = pinned (every root is); empty = only the roots
  std::vector<Pose> rest_roots;      ///< per strand, in the groom's frame; z is the rest tangent at the root

  // The strand as an elastic rod, see docs/solver.md. Entry i of a strand is its vertex i, edge (i, i + 1) or
  // the joint before edge i; the last edge and joint entry is unused. Masses and stiffnesses are divided by
  // the strand's `reference_mass`.
  std::vector<Quat> rest_frames;  ///< per edge, material frame in the root frame; z is the edge's tangent
  std::vector<Vec3> rest_strain;  ///< per joint, Darboux vector at rest: bending x y and twist z, in the
                                  ///< frame before the joint
  std::vector<float> bend;  ///< per joint, bending stiffness B / cell length / reference mass, m^2/s^2; joint
                            ///< 0 has half a cell
  std::vector<float> twist;  ///< per joint, twisting stiffness C / cell length / reference mass, m^2/s^2
  std::vector<float> mass;   ///< per vertex, mass / reference mass, about 1
  std::vector<float> rest_tension;    ///< per edge, tension / reference mass in the rest shape, m/s^2
  std::vector<float> reference_mass;  ///< per strand, kg: its mean vertex mass

  // Grooming, see Material: tethers, and factors on the values of Parameters. All arrays are empty if no
  // strand has a tether and every factor is 1.
  std::vector<float> air_drag_scale, goal_scale;     ///< per vertex
  std::vector<float> damping_scale, friction_scale;  ///< per strand
  std::vector<float> tether;                         ///< per vertex, m from the root; kNoTether = none
  /// Factor on damping_scale per joint, and on friction_scale per vertex. Both are empty if they are 1
  /// everywhere; otherwise the other grooming arrays are filled, too.
  std::vector<float> damping_along, friction_along;

  /// Per vertex, m: signed distance from the bodies with RigidBody::holds_roots in the rest shape, negative
  /// inside. The clearance of a vertex from every body is min(hair radius, rest_distance). Vertices in the
  /// skin at rest, and their neighbours nearer than kSkinDepth, may go kSkinDepth deeper, so that they find
  /// back. -kFarFromBodies: no body holds the vertex. Empty = all are kFarFromBodies.
  std::vector<float> rest_distance;

  // Bones that carry roots and pinned vertices. A bone's pose is its motion since the groom's rest, like the
  // head's.
  std::vector<std::string> bones{"head"};  ///< names; the first is the head
  std::vector<uint16_t> root_bones;        ///< per strand, bone of its root frame; empty = the head
  std::vector<uint16_t>
      pin_bones;  ///< per pinned vertex, its bone (other entries unused); empty = the bone of its root

  uint16_t rootBone(size_t strand) const { return root_bones.empty() ? 0 : root_bones[strand]; }
  bool isPinned(size_t strand, uint32_t vertex) const {
    return vertex == offsets[strand] || (!pinned.empty() && pinned[vertex] != 0);
  }
  /// Whether a vertex is pinned to another bone than its root frame.
  bool isBonePinned(size_t strand, uint32_t vertex) const {
    return !pin_bones.empty() && vertex > offsets[strand] && isPinned(strand, vertex) &&
           pin_bones[vertex] != rootBone(strand);
  }
  /// Rest position, m, in the groom's frame.
  Vec3 restPosition(size_t strand, uint32_t vertex) const {
    return rest_roots[strand].apply(rest_local[vertex]);
  }
  /// Factor on the damping time at the joint before the edge that begins at a vertex, and factor on friction
  /// at a vertex. Precondition: the model has grooming factors.
  float dampingFactor(size_t strand, uint32_t vertex) const {
    return damping_scale[strand] * (damping_along.empty() ? 1 : damping_along[vertex]);
  }
  float frictionFactor(size_t strand, uint32_t vertex) const {
    return friction_scale[strand] * (friction_along.empty() ? 1 : friction_along[vertex]);
  }
  /// Whether a factor of the strand differs from 1.
  bool hasFactors(size_t strand) const;
  bool hasTethers(size_t strand) const {
    return !tether.empty() && tether[offsets[strand + 1] - 1] < kNoTether;
  }
  size_t strands() const { return offsets.size() - 1; }
  size_t vertices() const { return rest_local.size(); }
  size_t verticesOf(size_t strand) const { return offsets[strand + 1] - offsets[strand]; }
};

/// Classification of a strand's bends at rest: bendsUnevenly() and isSharp() of kernels/rod.h.
struct RestBends {
  bool uneven, sharp;
};
RestBends restBends(const StrandModel& model, size_t strand);
/// Relative tolerance, over the mean, within which the edges of a strand count as equally long and its inner
/// vertices as equally heavy. It follows from the rounding of float coordinates at the strand's distance from
/// the origin.
float evenTolerance(const StrandModel& model, size_t strand);
/// Whether a strand has a free vertex before a pinned one.
bool hangsBetweenPins(const StrandModel& model, size_t strand);

/// Greatest `bend` and `twist`, m^2/s^2: 100 times that of the shortest fur. A strand with this stiffness in
/// every joint steps to finite numbers in float at any time step.
constexpr float kStiffestJoint = 1e9f;

/// Dynamic state of all strands, natural order. `frames`, `tensions` and `contacts` belong to the rod solver
/// and may be empty: a step then starts from untwisted frames, zero tension and no contact.
struct StrandState {
  std::vector<Vec3> positions;   ///< per vertex, metres, world
  std::vector<Vec3> velocities;  ///< per vertex, m/s, world
  /// Per edge (i, i + 1), material frame, world; z is the edge's tangent. The elastic energy of the rod is,
  /// per joint and in J,
  ///   reference_mass / 2 x (bend |k_xy - rest k_xy|^2 + twist (k_z - rest k_z)^2)
  /// with the strain k as in rest_strain: 2 tan(angle / 2) along the axis of the rotation from the frame
  /// before the joint to the frame after it, in the frame before it (Bergou et al. 2008; Kugelstadt and
  /// Schoemer 2016; docs/solver.md (1), (2)).
  std::vector<Quat> frames;
  std::vector<float> tensions;  ///< per edge, tension / reference mass, m/s^2: warm start of the next substep
  std::vector<Vec3> contacts;   ///< per vertex, contact force of the bodies / reference mass, m/s^2, world:
                                ///< warm start of the next substep
};

/// Builds a model from rest strands. Strands must have 2 to 128 vertices within kFarthestPose of the origin
/// and edges of positive length. Throws Error naming the strand otherwise, and as checkStrandSet() and
/// checkMaterial() do.
///
/// Edges are not merged or resampled: a strand with an edge shorter than a tenth of its mean edge never comes
/// to rest under `rod` (cleanStrands() of groom/groom_operations.h merges such vertices).
///
/// `materials`: at least one, indexed by StrandSet::parts; the last one serves all further parts.
StrandModel makeStrandModel(const StrandSet& rest, const std::vector<Material>& materials = {Material{}});

/// Throws Error, naming `where` and the array, if arrays of a model do not fit each other, are missing, or
/// contain a number that is not finite or out of range. Also if only some of the grooming arrays are filled.
/// The result of makeStrandModel() passes unless bend or twist exceeds kStiffestJoint.
void checkModel(const StrandModel& model, const std::string& where);

/// Index of the bone of this name, which is added if the model has none. Throws Error, naming it, if the
/// model would have more than 65,535 bones besides the head.
uint16_t addBone(StrandModel& model, const std::string& bone);

/// Pins the vertices of a strand from `from` to `to` to a bone. `from`, `to`: fractions of the arc length
/// from the root (0) to the tip (1); at 0 the root frame is pinned, too. Throws Error, naming the bone, on an
/// unknown bone or strand, an empty or reversed range, or a range without a vertex. Call it before
/// makeSagFree().
void pinToBone(StrandModel& model, size_t strand, float from, float to, uint16_t bone);
/// Same, with addBone().
void pinToBone(StrandModel& model, size_t strand, float from, float to, const std::string& bone);

/// The rest shape carried rigidly by `roots`, without velocity. `roots`: one pose per strand, otherwise
/// Error.
StrandState restState(const StrandModel& model, const std::vector<Pose>& roots);

/// Distance of a vertex from its root, in rest lengths of the strand, beyond which the strand has diverged.
/// Only gauss_seidel could reach it.
inline constexpr float kDivergedReach = 2;

/// Rest length per strand, m.
std::vector<float> strandLengths(const StrandModel& model);

/// Bounds of all vertices in the rest shape, m, in the groom's frame.
Box restBox(const StrandModel& model);

/// 64-bit FNV-1a over the bytes of positions and velocities: equal motion gives equal hashes.
uint64_t stateHash(const StrandState& state);

constexpr uint32_t kMinVerticesPerStrand = 2;
constexpr uint32_t kMaxVerticesPerStrand = 128;

}  // namespace strandcast
