#pragma once
#include <functional>
#include <string>
#include <vector>

namespace strandcast {

enum Kernel {
  kSolveDistance,
  kSolveAngular,
  kRotationBetween,
  kRotate,
  kInterpolateRotation,
  kSphereDistance,
  kCapsuleDistance,
  kPlaneDistance,
  kResolveContact,
  kPredictPosition,
  kNormalizeOrZero,
  kCarriedBy,
  kMultiply,
  kFieldPlace,
  kTrilinear,
  kFarDistance,
  kDistanceOutsideGrid,
  kGoalPull,
  kDrawnToGoal,
  kTethered,
  kGridPlace,
  kInterpolated,
  kSplatWeight,
  kMacCormack,
  kCrowding,
  kDragNotFelt,
  kHeldCrowding,
  kTaperedCapsuleDistance,
  kBoxDistance,
  kEllipsoidDistance,
  kConvexPlane,
  kFieldDistance,
  kBlurred,
  kLargestCrowding,
  kPushAlong,
  kBend,
  kBentDistance,
  kLastTurn,
  kHeldPlace,
  kHeldForce,
  kDraggedAmong,
  kWords,
  kKernels
};
constexpr int kKernelInputs = 16, kKernelOutputs = 9;

/// Runs `kernel` on items 0 .. count - 1: `in` is [kKernelInputs][count], `out` [kKernelOutputs][count].
/// `count` is a multiple of 16 and both start at multiples of 64 bytes.
using KernelRunner = std::function<void(int kernel, const float* in, float* out, size_t count)>;

struct KernelInstantiation {
  std::string name;  ///< e.g. "AVX3"
  KernelRunner run;
};
/// One per Highway target that was compiled and that this machine has.
std::vector<KernelInstantiation> highwayInstantiations();
/// GLSL on the machine's GL device; `run` is empty when there is none, and the name says why.
KernelInstantiation glslInstantiation();

}  // namespace strandcast
