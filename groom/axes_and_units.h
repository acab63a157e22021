#pragma once
#include <span>
#include <string>

#include "core/geometry.h"
#include "groom/groom_file.h"

namespace strandcast {

/// Throws Error unless `unit_meters` is 0 (guess) or a positive finite number.
void checkUnit(float unit_meters);

/// Whether two units are one but for rounding.
bool isSameUnit(float a, float b);

/// Whether something is below 1 mm or above 20 m large, as neither hair nor a body is.
bool isUnlikelySize(float meters);

/// Usual units, other than `taken`, with which a groom of `size` file units is more nearly as large as a head
/// of hair, at most three: "0.0254 m (inches) would make it 0.38 m large"; empty where there are none.
std::string likelierUnits(float size, float taken);

/// "X", "Y", "Z" or "auto".
const char* nameOf(UpAxis axis);

/// Turns points so that Y is up, by a quarter turn that keeps handedness: Z up (x, y, z) -> (x, z, -y), X up
/// (x, y, z) -> (-y, x, z). kAuto and kY leave them.
void turnYUp(std::span<Vec3> points, UpAxis up);

/// The way back from turnYUp's Y up to Z up, bit for bit: (x, y, z) -> (x, -z, y).
void turnZUp(std::span<Vec3> points);

/// Multiplies points by `unit_meters`. Throws Error naming `name` when one then lies further than
/// kFarthestPose from the origin: no hair is there.
void scaleToMeters(std::span<Vec3> points, float unit_meters, const std::string& name);

}  // namespace strandcast
