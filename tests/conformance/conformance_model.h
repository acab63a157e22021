#pragma once
#include <functional>
#include <random>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Strands with vertex counts 2, 3, 5, 16, 17, 31, 100 and 128 mixed, curled, 5 cm to 40 cm long, on a disc
/// of 10 cm radius about the origin; the tip of every fifth strand is pinned; three parts take turns. Seeded.
StrandModel awkwardModel(size_t strands, uint32_t seed,
                         const std::vector<Material>& materials = {Material{}});

/// Human hair, and two materials with factors of air drag, goal rate, damping time and friction that are
/// not 1.
std::vector<Material> groomedMaterials();

/// Ties strands of `model` to two more bones, "clip" and "ribbon": in the middle, as a whole, at both ends.
void tieToBones(StrandModel& model);
/// Of the head, the clip and the ribbon, moved by about a millimetre and turned a little.
std::vector<Pose> movedBones();

/// The rest shape of `model` at its own roots, every vertex moved by up to a fifth of its edge and given a
/// velocity of up to 1 m/s.
StrandState disturbedState(const StrandModel& model, uint32_t seed);

/// Positions and velocities moved by half a unit in the last place, up or down. What the oracle's answer
/// moves by then, the most of kNudges of them, tells what a rounding may do to a strand.
StrandState nudged(StrandState state, uint32_t seed);
constexpr uint32_t kNudges = 8;

/// A sphere, a capsule and a plane that the hair of awkwardModel lies in, all moving and turning, with
/// friction.
std::vector<MovingPrimitive> movingBodies(float dt);

/// One body of each kind that movingBodies has not (by number, 0 to kFurtherKinds - 1; the last is the field
/// bent), moving and turning, that the hair of awkwardModel lies in. What it needs is added to `shapes`.
constexpr int kFurtherKinds = 6;
MovingPrimitive furtherBody(int kind, float dt, ShapeData& shapes);
/// That of the bent one at the end of the step, about the middle of its ring.
SurfaceBend bendOfRing();

/// StrandModel::rest_distance for which what is in a body at the start may stay a millimetre deeper. Hair
/// that has to leave a body centimetres thick turns on the last bit of where it is.
std::vector<float> leftWhereTheyStart(const StrandState& from, std::span<const MovingPrimitive> bodies,
                                      std::span<const uint32_t> words = {});

/// The signed distance field of a function that is one, in cells of `cell`, with bricks stored within `band`.
DistanceField sampledField(const std::function<float(const Vec3&)>& distance, const Box& box, float cell,
                           float band);

/// A pose of the head, moved by 2 cm and turned by 0.3 rad about an axis through its middle.
Pose movedHead();

}  // namespace strandcast
