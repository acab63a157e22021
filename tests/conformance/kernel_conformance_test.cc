// Runs the kernels in every instantiation and compares them with the one in double precision, on random and
// on degenerate inputs.
#include "tests/conformance/kernel_conformance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/strand_block.h"
#include "kernels/scalar_grid.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
namespace kernels::f64 {
// clang-format off
#include "kernels/lanes_macros.inl"
#include "tests/conformance/shaders/kernel_cases.h"
#include "kernels/end_lanes.inl"
// clang-format on
}  // namespace kernels::f64
namespace kernels::f32 {
// clang-format off
#include "kernels/lanes_macros.inl"
#include "tests/conformance/shaders/kernel_cases.h"
#include "kernels/end_lanes.inl"
// clang-format on
}  // namespace kernels::f32

namespace {

constexpr size_t kItems = 1003;
constexpr size_t kPadded = 1008;  // 16 lanes
constexpr const char* kNames[kKernels] = {"solveDistance",
                                          "solveAngular",
                                          "rotationBetween",
                                          "rotate",
                                          "interpolateRotation",
                                          "sphereDistance",
                                          "capsuleDistance",
                                          "planeDistance",
                                          "resolveContact",
                                          "predictPosition",
                                          "normalizeOrZero",
                                          "carriedBy",
                                          "multiply",
                                          "fieldPlace",
                                          "trilinear",
                                          "farDistance",
                                          "distanceOutsideGrid",
                                          "goalPull",
                                          "drawnToGoal",
                                          "tethered",
                                          "gridPlace",
                                          "interpolated",
                                          "splatWeight",
                                          "macCormack",
                                          "crowding",
                                          "slipDragLoss",
                                          "heldCrowding",
                                          "taperedCapsule",
                                          "boxDistance",
                                          "ellipsoid",
                                          "convexPlane",
                                          "fieldDistance",
                                          "blurred",
                                          "largestCrowding",
                                          "pushAlong",
                                          "bend",
                                          "bentDistance",
                                          "gapToRemove",
                                          "positionOnSurface",
                                          "heldForce",
                                          "draggedAmong",
                                          "words"};

using Item = std::array<float, kKernelInputs>;
using Row = std::vector<float, CacheLineAllocator<float>>;

class InputMaker {
 public:
  explicit InputMaker(uint32_t seed) : random_(seed) {}
  float number(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  void vector(float* out, float size) {
    for (int c = 0; c < 3; ++c) out[c] = number(-size, size);
  }
  void unit(float* out, int n) {
    float l2 = 0;
    do {
      l2 = 0;
      for (int c = 0; c < n; ++c) {
        out[c] = number(-1, 1);
        l2 += out[c] * out[c];
      }
    } while (l2 < 0.01f);
    for (int c = 0; c < n; ++c) out[c] /= std::sqrt(l2);
  }

  Item ordinary(int kernel) {
    Item item{};
    float* v = item.data();
    switch (kernel) {
      case kSolveDistance:
      case kSolveAngular:
        vector(v, 0.3f), vector(v + 3, 0.3f);
        v[6] = number(0, 3) < 1 ? 0.0f : 1.0f, v[7] = 1, v[8] = number(0.001f, 0.3f);
        if (kernel == kSolveDistance) break;
        vector(v + 6, 0.3f), vector(v + 12, 0.3f), v[15] = number(0, 1);
        for (int c = 9; c < 12; ++c) v[c] = number(0, 3) < 1 ? 0.0f : 1.0f;
        break;
      case kRotationBetween:
        unit(v, 3), unit(v + 3, 3);
        break;
      case kRotate:
        unit(v, 4), vector(v + 4, 0.3f);
        break;
      case kMultiply:
      case kInterpolateRotation:
        unit(v, 4), unit(v + 4, 4), v[8] = number(0, 1);
        break;
      case kSphereDistance:
        vector(v, 0.3f), vector(v + 3, 0.3f), v[6] = number(0, 0.3f);
        break;
      case kCapsuleDistance:
        vector(v, 0.3f), vector(v + 3, 0.3f), vector(v + 6, 0.3f), v[9] = number(0, 0.3f);
        break;
      case kPlaneDistance:
        vector(v, 0.3f), vector(v + 3, 0.3f), unit(v + 6, 3);
        break;
      case kResolveContact:
      case kHeldPlace:
        vector(v, 0.3f), vector(v + 6, 0.01f), unit(v + 9, 3);
        for (int c = 0; c < 3; ++c) v[3 + c] = v[c] + number(-0.02f, 0.02f);
        v[12] = number(-0.05f, 0.02f), v[13] = number(0, 1), v[14] = number(0.5f, 2);
        v[15] = number(-0.01f, 0.05f);
        break;
      case kLastTurn:
        vector(v, 0.01f), vector(v + 3, 0.01f), vector(v + 6, 0.01f), unit(v + 9, 3);
        v[12] = number(-0.006f, 0);
        break;
      case kHeldForce:
        vector(v, 0.05f), vector(v + 3, 0.05f), vector(v + 6, 0.05f), unit(v + 9, 3);
        v[12] = number(0, 1), v[13] = number(0, 1);
        break;
      case kPredictPosition:
        vector(v, 0.3f), vector(v + 3, 3), vector(v + 6, 10), vector(v + 9, 10);
        v[12] = number(0, 1), v[13] = number(0.0001f, 0.03f);
        break;
      case kNormalizeOrZero:
        vector(v, 1);
        for (int c = 0, exponent = static_cast<int>(number(-50, 50)); c < 3; ++c)
          v[c] = std::ldexp(v[c], exponent);
        break;
      case kCarriedBy:
        vector(v, 0.3f), vector(v + 3, 0.3f), vector(v + 6, 0.01f), vector(v + 9, 0.1f);
        break;
      case kFieldPlace:  // well within a cell: at a border rounding may choose the neighbour
        vector(v + 3, 0.3f);
        v[6] = number(0.001f, 0.01f);
        for (int c = 0; c < 3; ++c) {
          v[7 + c] = std::floor(number(1, 4));
          v[c] = v[3 + c] + v[6] * (std::floor(number(0, 8 * v[7 + c])) + number(0.1f, 0.9f));
        }
        break;
      case kTrilinear:
        for (int c = 0; c < 8; ++c) v[c] = number(-30000, 30000);
        for (int c = 8; c < 11; ++c) v[c] = number(0, 1);
        break;
      case kFarDistance:
        v[0] = number(-0.3f, 0.3f), v[4] = number(0.01f, 0.1f);
        for (int c = 1; c < 4; ++c) v[c] = number(0, 1);
        v[5] = v[0] < 0 ? -1.0f : 1.0f, v[6] = number(0, 0.02f);
        break;
      case kDistanceOutsideGrid:
        vector(v, 0.3f), v[3] = number(0, 0.02f);
        break;
      case kGoalPull:
        vector(v, 0.01f), vector(v + 3, 0.3f), vector(v + 6, 0.3f);
        v[9] = number(0.5f, 2), v[10] = number(0, 300), v[11] = number(0.0001f, 0.01f);
        break;
      case kDrawnToGoal:
        vector(v, 0.3f), vector(v + 3, 0.3f), v[6] = number(0, 300), v[7] = number(0.0001f, 0.01f);
        break;
      case kTethered:
        vector(v, 0.3f), vector(v + 3, 0.3f), v[6] = number(0.001f, 0.6f);
        break;
      case kGridPlace:  // well within a cell, as above
        v[3] = std::floor(number(4, 128));
        for (int c = 0; c < 3; ++c) v[c] = std::floor(number(0, v[3])) + number(0.1f, 0.9f);
        break;
      case kInterpolated:
        for (int c = 0; c < 8; ++c) v[c] = number(-30, 30);
        for (int c = 8; c < 11; ++c) v[c] = number(0, 1);
        break;
      case kSplatWeight:
        for (int c = 0; c < 3; ++c) v[c] = number(0, 1), v[3 + c] = number(0, 2) < 1 ? 0.0f : 1.0f;
        break;
      case kMacCormack:
        for (int c = 0; c < 3; ++c) v[c] = number(-30, 30);
        v[3] = number(-30, 0), v[4] = number(0, 30);
        break;
      case kCrowding:
        v[0] = number(0.5f, 2), v[1] = number(0.5f, 2), v[2] = number(0, 10);
        break;
      case kDragNotFelt:
        vector(v, 10), unit(v + 3, 3), v[6] = number(0, 10), v[7] = number(0, 1);
        break;
      case kDraggedAmong:
        vector(v, 10), vector(v + 3, 10), v[6] = number(0, 20), vector(v + 7, 0.01f), v[10] = number(0, 0.9f);
        break;
      case kWords:
        vector(v, 10);
        break;
      case kHeldCrowding:
        v[0] = number(0, 2), v[1] = number(0.5f, 2), v[2] = number(0.5f, 2), v[3] = number(0, 10);
        v[4] = number(0, 1), v[5] = number(1, 3);
        break;
      case kTaperedCapsuleDistance:
        vector(v, 0.3f), vector(v + 3, 0.3f);
        unit(v + 6, 3);
        for (int c = 0; c < 3; ++c) v[6 + c] = v[3 + c] + 0.2f * v[6 + c];
        v[9] = number(0.01f, 0.1f), v[10] = number(0.01f, 0.1f);
        break;
      case kBoxDistance:
        vector(v, 0.3f);
        for (int c = 3; c < 6; ++c) v[c] = number(0.05f, 0.2f);
        break;
      case kEllipsoidDistance:
        vector(v, 0.3f);
        for (int c = 3; c < 6; ++c) v[c] = number(0.05f, 0.2f);
        break;
      case kConvexPlane:
        vector(v, 0.3f), unit(v + 3, 3), v[6] = number(-0.2f, 0.2f), v[7] = number(-0.3f, 0.3f),
                                         unit(v + 8, 3);
        break;
      case kFieldDistance:
        for (int c = 0; c < 8; ++c)
          v[c] = number(0, 10) + 10 * static_cast<float>((c & 1) + 2 * (c >> 1 & 1) + 3 * (c >> 2));
        for (int c = 8; c < 11; ++c) v[c] = 0.01f * (std::floor(number(0, 8)) + number(0.1f, 0.9f));
        v[11] = std::floor(number(-1, 2)), v[12] = number(0.02f, 0.05f), v[13] = 0.01f,
        v[14] = number(0, 0.01f);
        break;
      case kBlurred:
        for (int c = 0; c < 3; ++c) v[c] = number(-10, 10);
        break;
      case kLargestCrowding:
        v[0] = number(0, 2), v[1] = number(0.01f, 2);
        break;
      case kPushAlong:
        for (int c = 0; c < 5; ++c) v[c] = number(0, 5);
        v[5] = number(-1, 0);
        break;
      case kBend:
        vector(v, 0.2f), v[15] = number(0.05f, 0.3f);
        for (int c = 3; c < 15; ++c) v[c] = number(-0.3f, 0.3f);
        break;
      case kBentDistance:
        v[0] = number(-4e-3f, 4e-3f), v[1] = number(1, 2), unit(v + 2, 3);
        for (int c = 2; c < 5; ++c) v[c] *= 1.5f;
        break;
    }
    return item;
  }

 private:
  std::mt19937 random_;
};

// Makes an ordinary input degenerate. `way` enumerates the degenerate cases of the kernel.
Item nasty(int kernel, Item item, size_t way) {
  float* v = item.data();
  switch (kernel) {
    case kSolveDistance:
    case kSolveAngular:
      if (way % 4 == 0) std::copy(v, v + 3, v + 3);              // coincident
      if (way % 4 == 1) v[6] = v[7] = v[9] = v[10] = v[11] = 0;  // all pinned
      if (way % 4 == 2) std::fill(v, v + 9, 0.0f);               // coincident at the origin
      if (way % 4 == 3) v[3] = std::nextafter(v[0], 9.0f), v[4] = v[1], v[5] = v[2];  // adjacent floats
      break;
    case kRotationBetween:
      if (way % 4 == 0) std::copy(v, v + 3, v + 3);                  // equal
      for (int c = 0; way % 4 == 1 && c < 3; ++c) v[3 + c] = -v[c];  // opposite
      if (way % 4 == 2) std::fill(v + 3, v + 6, 0.0f);               // a missing edge
      if (way % 4 == 3) std::fill(v, v + 6, 0.0f);
      break;
    case kInterpolateRotation:
      for (int c = 0; way % 2 == 0 && c < 4; ++c) v[4 + c] = -v[c];  // the same rotation, negated
      v[8] = way % 4 < 2 ? 0.0f : 1.0f;
      break;
    case kSphereDistance:
      std::copy(v, v + 3, v + 3);  // at the centre
      if (way % 2 == 0) v[6] = 0;
      break;
    case kCapsuleDistance:
      if (way % 3 == 0) std::copy(v + 3, v + 6, v + 6);                   // no axis
      if (way % 3 == 1) std::copy(v, v + 3, v + 3);                       // at an end
      if (way % 3 == 2) item = {0, 0.25f, 0, 0, 0, 0, 0, 0.5f, 0, v[9]};  // on the axis
      break;
    case kHeldForce:
      if (way % 2 == 0) std::fill(v, v + 9, 0.0f);
      break;
    case kResolveContact:
    case kHeldPlace:
      if (way % 4 == 0) v[12] = v[15] = 0;
      if (way % 4 == 1) v[13] = 0;
      if (way % 4 == 2) std::copy(v, v + 3, v + 3), std::fill(v + 6, v + 9, 0.0f);  // at rest
      if (way % 4 == 3) v[13] = 1000;
      break;
    case kLastTurn:
      if (way % 2 == 0) std::copy(v, v + 3, v + 3), std::copy(v, v + 3, v + 6);  // all points coincide
      break;
    case kPredictPosition:
      v[12] = static_cast<float>(way % 2);  // drag keeps all or nothing of the velocity
      break;
    case kGoalPull:
    case kDrawnToGoal:
      v[kernel == kGoalPull ? 10 : 6] = way % 2 == 0 ? 0.0f : 1e4f;  // off; or nearly as stiff as a pin
      break;
    case kTethered:
      if (way % 2 == 0) std::copy(v, v + 3, v + 3);  // at the root
      if (way % 2 == 1) v[6] = 0;
      break;
    case kNormalizeOrZero:
      std::fill(v, v + 3, way % 2 == 0 ? 0.0f : 1e-30f);
      break;
    case kFieldPlace:  // beyond the grid on one side or another
      v[way % 3] += way % 2 == 0 ? 1.0f : -1.0f;
      break;
    case kTrilinear:
      if (way % 2 == 0) std::fill(v, v + 8, v[0]);
      for (int c = 8; way % 2 == 1 && c < 11; ++c) v[c] = std::round(v[c]);
      break;
    case kFarDistance:
      for (int c = 1; c < 4; ++c) v[c] = std::round(v[c]);
      v[5] = way % 2 == 0 ? v[5] : -v[5];
      break;
    case kDistanceOutsideGrid:
      std::fill(v, v + 2, 0.0f);
      break;
    case kGridPlace:  // beyond the grid on one side or another
      v[way % 3] += way % 2 == 0 ? 1000.0f : -1000.0f;
      break;
    case kSplatWeight:
      for (int c = 0; c < 3; ++c) v[c] = std::round(v[c]);
      break;
    case kCrowding:  // as dense as at rest; zero density
      if (way % 2 == 0) v[1] = v[0];
      if (way % 2 == 1) v[0] = v[1] = 0;
      break;
    case kHeldCrowding:  // as dense as at rest; both ends of the range
      if (way % 3 == 0) v[2] = v[1];
      if (way % 3 == 1) v[0] = v[5];
      if (way % 3 == 2) v[0] = 0;
      break;
    case kDraggedAmong:
      if (way % 3 == 0) v[6] = 0;                        // no hair to exchange momentum with
      if (way % 3 == 1) std::fill(v + 7, v + 10, 0.0f);  // a segment without direction
      if (way % 3 == 2) v[10] = 0;                       // equal drag along and across
      break;
    case kLargestCrowding:  // zero at rest; much more than one sample
      v[0] = way % 2 == 0 ? 0.0f : 100 * v[1];
      break;
    case kTaperedCapsuleDistance:
      if (way % 4 == 0) v[10] = v[9];  // a capsule
      if (way % 4 == 1) v[9] = 0.5f;   // the first ball in the other
      if (way % 4 == 2) v[10] = 0.5f;  // the other ball in the first
      if (way % 4 == 3) item = {0, 0.25f, 0, 0, 0, 0, 0, 0.5f, 0, v[9], v[10]};  // on the axis
      break;
    case kBoxDistance:
      if (way % 2 == 0) std::fill(v, v + 3, 0.0f);  // in the middle
      if (way % 2 == 1) v[0] = 0.3f, std::fill(v + 1, v + 3, 0.0f);
      break;
    case kEllipsoidDistance:
      if (way % 3 == 0) v[3] = v[4] = v[5];            // a sphere
      if (way % 3 == 1) v[way % 2] = 0, v[5] = 0.01f;  // flat; on a plane of symmetry
      if (way % 3 == 2) v[1] = v[2] = 0, v[0] = 0.3f;  // on an axis
      break;
    case kFieldDistance:
      if (way % 2 == 0) std::fill(v, v + 8, v[0]);                      // zero gradient
      if (way % 2 == 1) v[8 + way % 3] += way % 4 == 1 ? 1.0f : -1.0f;  // beyond the grid
      break;
    case kBend:  // beyond its box
      v[way % 3] = way % 2 == 0 ? 1.0f : -1.0f;
      break;
    case kBentDistance:
      if (way % 3 == 0) v[0] *= 2.5f;                   // farther
      if (way % 3 == 1) std::fill(v + 2, v + 5, 0.0f);  // zero gradient
      if (way % 3 == 2)
        for (int c = 2; c < 5; ++c) v[c] *= 0.1f;
      break;
    default:
      break;
  }
  return item;
}

double norm(const float* v, int n) {
  double sum = 0;
  for (int c = 0; c < n; ++c) sum += static_cast<double>(v[c]) * v[c];
  return std::sqrt(sum);
}
double distance(const float* a, const float* b) {
  return std::hypot(double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]);
}

// Condition number: amplification of a rounding error by the problem itself; at least 1.
double condition(int kernel, const Item& item, double distance_out) {
  const float* v = item.data();
  if (kernel ==
      kRotationBetween) {  // for nearly opposite vectors the quaternion is short before normalisation
    const double cosine = double(v[0]) * v[3] + double(v[1]) * v[4] + double(v[2]) * v[5];
    const double w = std::max(1 + cosine, 1e-3);
    return 1 / std::min(1.0, std::sqrt(w * w + std::max(0.0, 1 - cosine * cosine)));
  }
  if (kernel == kSolveAngular) {  // a short parent edge rotates far
    const double parent = distance(v, v + 6);
    return parent > 0 ? std::max(1.0, norm(v + 12, 3) / parent) : 1;
  }
  if (kernel == kTaperedCapsuleDistance)  // direction from a near axis; slope of the cone
    return std::max(1.0, norm(v, 3) / std::max(1e-3, distance_out + std::min(v[9], v[10]))) *
           distance(v, v + 3) / distance(v + 3, v + 6) * 4;
  if (kernel == kEllipsoidDistance)  // curvature of the surface
    return std::pow(*std::max_element(v + 3, v + 6) / *std::min_element(v + 3, v + 6), 2);
  if (kernel == kSphereDistance ||
      kernel == kCapsuleDistance) {  // direction from a near centre; along a short axis
    const double from_axis = distance_out + (kernel == kSphereDistance ? v[6] : v[9]);
    double out = from_axis > 1e-12 ? std::max(1.0, norm(v, 3) / from_axis) : 1;
    const double axis = kernel == kCapsuleDistance ? distance(v + 3, v + 6) : 0;
    if (axis > 1e-12) out = std::max({out, distance(v, v + 3) / axis, out * distance(v, v + 3) / axis});
    return out;
  }
  return 1;
}

struct Inputs {
  std::vector<Item> items;  // kItems
  Row planes;               // [kKernelInputs][kPadded]
};

Inputs makeInputs(int kernel) {
  InputMaker maker(100 + kernel);
  Inputs inputs;
  for (size_t i = 0; i < kItems; ++i) {
    const Item item = maker.ordinary(kernel);
    inputs.items.push_back(i % 8 == 7 ? nasty(kernel, item, i / 8) : item);
  }
  inputs.planes.resize(kKernelInputs * kPadded);
  for (size_t i = 0; i < kPadded; ++i)
    for (int c = 0; c < kKernelInputs; ++c) inputs.planes[c * kPadded + i] = inputs.items[i % kItems][c];
  return inputs;
}

std::array<double, kKernelOutputs> truth(int kernel, const Item& item) {
  kernels::f64::KernelInput in;
  std::copy(item.begin(), item.end(), in.v);
  const auto out = kernels::f64::runKernel(kernel, in);
  std::array<double, kKernelOutputs> result;
  std::copy(out.v, out.v + kKernelOutputs, result.begin());
  return result;
}

// In units of float's rounding (6e-8) of the largest number of the item, times condition(). Measured: 7.2 for
// every instantiation on one CPU. A GPU may err by 2.5 units more in each division and square root.
constexpr double kTolerance = 16;

void compare(const std::string& name, const KernelRunner& run) {
  std::printf("[ ran on   ] %s\n", name.c_str());
  double worst_of_all = 0;
  for (int kernel = 0; kernel < kKernels; ++kernel) {
    const Inputs inputs = makeInputs(kernel);
    Row out(kKernelOutputs * kPadded);
    run(kernel, inputs.planes.data(), out.data(), kPadded);
    double worst = 0;
    size_t worst_item = 0;
    for (size_t i = 0; i < kItems; ++i) {
      const auto expected = truth(kernel, inputs.items[i]);
      double scale = 0, error = 0;
      for (float x : inputs.items[i]) scale = std::max<double>(scale, std::fabs(x));
      for (int c = 0; c < kKernelOutputs; ++c) {
        scale = std::max(scale, std::fabs(expected[c]));
        const double off = std::fabs(out[c * kPadded + i] - expected[c]);
        error = std::isfinite(off) ? std::max(error, off) : 1e30;
      }
      error /= std::max(scale, 1e-30) * 5.96e-8 * condition(kernel, inputs.items[i], expected[0]);
      if (error > worst) worst = error, worst_item = i;
    }
    EXPECT_LT(worst, kTolerance) << name << ", " << kNames[kernel] << ", item " << worst_item;
    worst_of_all = std::max(worst_of_all, worst);
  }
  std::printf("             worst error %.1f units\n", worst_of_all);
}

TEST(KernelConformance, FloatScalar) {
  compare("float, scalar", [](int kernel, const float* in, float* out, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      kernels::f32::KernelInput input;
      for (int c = 0; c < kKernelInputs; ++c) input.v[c] = in[c * count + i];
      const auto output = kernels::f32::runKernel(kernel, input);
      for (int c = 0; c < kKernelOutputs; ++c) out[c * count + i] = output.v[c];
    }
  });
}

TEST(KernelConformance, EveryHighwayTarget) {
  const std::vector<KernelInstantiation> list = highwayInstantiations();
  ASSERT_FALSE(list.empty());
  for (const KernelInstantiation& instantiation : list) compare(instantiation.name, instantiation.run);
}

TEST(KernelConformance, Glsl) {
  const KernelInstantiation glsl = glslInstantiation();
  if (!glsl.run) GTEST_SKIP() << glsl.name;
  compare(glsl.name, glsl.run);
}

// Tests the double instantiation itself against the meaning of the formulas.
TEST(KernelConformance, DoubleKeepsWhatTheFormulasPromise) {
  for (size_t i = 0; i < kItems; ++i) {
    const Item distance_item = makeInputs(kSolveDistance).items[i];
    if (i % 8 != 7) {
      const auto d = truth(kSolveDistance, distance_item);
      EXPECT_NEAR(std::hypot(d[3] - d[0], d[4] - d[1], d[5] - d[2]), distance_item[8], 1e-12);
    }
    if (i > 50) break;
  }
  const std::vector<Item> pairs = makeInputs(kRotationBetween).items;
  for (size_t i = 0; i < 50; ++i) {
    if (i % 8 == 7) continue;
    const auto q = truth(kRotationBetween, pairs[i]);
    kernels::f64::quat rotation{q[0], q[1], q[2], q[3]};
    const auto turned = kernels::f64::rotate(rotation, {pairs[i][0], pairs[i][1], pairs[i][2]});
    if (condition(kRotationBetween, pairs[i], 0) > 20) continue;
    EXPECT_NEAR(turned.x, pairs[i][3], 1e-6);
    EXPECT_NEAR(turned.y, pairs[i][4], 1e-6);
    EXPECT_NEAR(turned.z, pairs[i][5], 1e-6);
  }
  const std::array<double, kKernelOutputs> words = {-1, 2, -3, 1, -2, 3, 0, 0, 0};
  EXPECT_EQ(truth(kWords, {1, -2, 3}), words) << "negated; chosen by maskAll(); not chosen by maskNone()";
  Item contact = {0, 0.1f, 0, 0.01f, 0.12f, 0, 0, -0.02f, 0, 0, 1, 0, -0.02f, 0.3f, 0.5f, 0.02f};
  EXPECT_NEAR(truth(kResolveContact, contact)[1], 0.12, 1e-7) << "pushed out by its depth";
  EXPECT_NEAR(truth(kResolveContact, contact)[0], 0.006, 1e-7) << "taken along by friction x depth";
  auto held = truth(kHeldPlace, contact);  // force = 0.02 normal + `moved` = 0
  EXPECT_NEAR(held[1], 0.12, 1e-7) << "pushed out by its depth";
  EXPECT_NEAR(held[0], 0.006, 1e-7) << "taken along by friction x depth";
  EXPECT_NEAR(held[3], 0.5, 1e-7) << "half of what forces pressed is kept";
  EXPECT_NEAR(held[4], 0.012, 1e-7) << "and friction, by mass";
  contact[13] = 1;
  EXPECT_NEAR(truth(kResolveContact, contact)[0], 0.01, 1e-7) << "stuck";
  held = truth(kHeldPlace, contact);
  EXPECT_NEAR(held[0], 0.01, 1e-7) << "stuck";
  EXPECT_NEAR(held[4], 0, 1e-7) << "its own speed stops it, no force did";
  contact = {0, 0.1f, 0, 0, 0.099f, 0, 0, 0.0005f, 0, 0, 1, 0, 0.001f, 0.3f, 1, 0.0095f};
  const auto lifted = truth(kResolveContact, contact);
  EXPECT_NEAR(lifted[1], 0.1, 1e-7) << "not pulled";
  EXPECT_NEAR(lifted[4], 0.009, 1e-7) << "but pressed less";
  held = truth(kHeldPlace, contact);
  EXPECT_NEAR(held[1], 0.099, 1e-7) << "back on the surface, unless it is let go";
  EXPECT_NEAR(held[3], 1, 1e-7) << "and pressed less by all of what that takes";
  const auto force = truth(kHeldForce, {0, 0.04f, 0, 0.005f, -0.03f, 0, 0.02f, 0, 0, 0, 1, 0, 0.5f, 0.3f});
  EXPECT_NEAR(force[1], 0.025, 1e-7) << "by half of its normal reaction less";
  EXPECT_NEAR(force[0], 0.0075, 1e-7) << "with the friction that goes with it";
  const auto last_turn = [](float gap, float inner, float carried) {
    return truth(kLastTurn, {0, 0, 0, 0.01f, inner, 0, 0, carried, 0.01f, 0, 1, 0, gap})[0];
  };
  EXPECT_NEAR(last_turn(-0.004f, -0.001f, 0.0045f), -0.004, 1e-7) << "it was outside";
  EXPECT_NEAR(last_turn(-0.004f, 0.0045f, -0.001f), -0.004, 1e-7) << "its inner end is";
  EXPECT_NEAR(last_turn(-0.004f, 0, -0.001f), 0, 1e-7) << "all deep";
  EXPECT_NEAR(last_turn(-0.0025f, 0, -0.001f), -0.00125, 1e-7) << "half";
}

// Two planes whose normals make 116 degrees; an edge of 7.8 mm from the origin crosses both.
TEST(KernelConformance, AnEdgeIsTurnedIntoTheCreaseOfTwoPlanes) {
  namespace k = kernels::f64;
  constexpr double kLength = 0.0078;
  const k::real3 first{1, 0, 0}, second{-0.432, std::sqrt(1 - 0.432 * 0.432), 0}, inner{0, 0, 0};
  const auto heights_of = [&](const k::real3& x, double first_height, double second_height) {
    const k::real3 carried = x + (first + second) * 0.01;  // outside before the substep
    const k::real3 out = k::rotatedIntoCrease(x, inner, carried, first, k::dot(first, x) - first_height,
                                              carried, second, k::dot(second, x) - second_height, kLength);
    EXPECT_NEAR(k::length(out), kLength, 1e-12);
    EXPECT_GT(out.z, -1e-12) << "on the side where it was";
    return std::pair(k::dot(first, out) - first_height, k::dot(second, out) - second_height);
  };
  const k::real3 x{-0.0069, 0, 0.0036};
  const auto [first_gap, second_gap] = heights_of(x, -0.0032, 0.001);
  EXPECT_NEAR(first_gap, 0, 1e-9);
  EXPECT_NEAR(second_gap, 0, 1e-9);
  const auto [first_left, second_left] = heights_of(x, 0.0012, 0.0075);  // unreachable with this length
  EXPECT_LT(first_left, 0);
  EXPECT_LT(second_left, 0);
  EXPECT_NEAR(first_left / second_left, 0.0012 / 0.0075, 1e-6) << "as they ask of it";
}

}  // namespace
}  // namespace strandcast
