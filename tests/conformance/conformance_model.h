#pragma once
#include <functional>
#include <random>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Curled strands, 5 cm to 40 cm long, with vertex counts 2, 3, 5, 16, 17, 31, 100 and 128 mixed, on a disc
/// of 10 cm radius about the origin. The tip of every fifth strand is pinned. Three parts alternate from
/// strand to strand. Random by `seed`.
StrandModel awkwardModel(size_t strands, uint32_t seed,
                         const std::vector<Material>& materials = {Material{}});

/// Human hair, and two materials with factors other than 1 of air drag, goal rate, damping time and friction.
std::vector<Material> groomedMaterials();

/// Pins strands of `model` to two more bones, "clip" and "ribbon": some in the middle, some as a whole, some
/// at both ends.
void tieToBones(StrandModel& model);
/// Poses of head, clip and ribbon, translated by about 1 mm and rotated by up to 0.005 rad.
std::vector<Pose> movedBones();

/// The rest shape of `model` with every vertex but the roots displaced by up to a fifth of its edge's length,
/// at velocities of up to 1 m/s.
StrandState disturbedState(const StrandModel& model, uint32_t seed);

/// `state` with each component of position and velocity changed by half a unit in the last place, up or down.
/// The largest change of the oracle's result over kNudges such inputs estimates the effect of rounding on a
/// strand.
StrandState nudged(StrandState state, uint32_t seed);
constexpr uint32_t kNudges = 8;

/// A sphere, a capsule and a plane with friction that intersect the hair of awkwardModel(). All translate and
/// rotate in a step of `dt` s.
std::vector<MovingPrimitive> movingBodies(float dt);

/// A body of a kind that movingBodies() lacks, by number (0 to kFurtherKinds - 1; the last is the bent
/// field). It translates and rotates and intersects the hair of awkwardModel(). Its data are added to
/// `shapes`.
constexpr int kFurtherKinds = 6;
MovingPrimitive furtherBody(int kind, float dt, ShapeData& shapes);
/// Bend of the last kind at the end of the step, about the centre of its ring.
SurfaceBend bendOfRing();

/// StrandModel::rest_distance that lets vertices that start inside a body stay, up to 1 mm deeper. Hair that
/// has to leave a body from centimetres of depth depends on the last bit of its position.
std::vector<float> restDistancesAtStart(const StrandState& from, std::span<const MovingPrimitive> bodies,
                                        std::span<const uint32_t> words = {});

/// Samples a signed distance function (m) inside `box`, in cells of `cell` m. Bricks within `band` m of the
/// surface are stored.
DistanceField sampledField(const std::function<float(const Vec3&)>& distance, const Box& box, float cell,
                           float band);

/// A pose of the head, translated by 2 cm and rotated by 0.3 rad about an axis through its centre.
Pose movedHead();

}  // namespace strandcast
