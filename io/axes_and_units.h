#pragma once
#include <span>
#include <string>

#include "core/geometry.h"
#include "io/groom_file.h"

namespace strandcast {

/// Throws Error unless `unit_meters` is 0 (guess the unit) or a positive finite number.
void checkUnit(float unit_meters);

/// Whether two units (metres per file unit) are equal within 1e-4 of the larger: files round their units.
bool isSameUnit(float a, float b);

/// Whether a size is below 1 mm or above 20 m. Neither hair nor a body has such a size.
bool isUnlikelySize(float meters);

/// Usual units other than `taken` that bring a groom of `size` file units nearer to the size of a head of
/// hair. At most three units, with which the groom is 0.1 to 1 m large; for example "0.0254 m (inches) would
/// make it 0.38 m large". Empty when there are none.
std::string likelierUnits(float size, float taken);

/// "X", "Y", "Z" or "auto".
const char* nameOf(UpAxis axis);

/// Rotates points so that Y is up, by a quarter turn that keeps handedness: Z up (x, y, z) -> (x, z, -y), X
/// up (x, y, z) -> (-y, x, z). kAuto and kY leave the points unchanged.
void rotateToYUp(std::span<Vec3> points, UpAxis up);

/// Inverse of rotateToYUp() for Z up, exact bit for bit: (x, y, z) -> (x, -z, y).
void rotateToZUp(std::span<Vec3> points);

/// Multiplies points by `unit_meters`. Throws Error naming `name` when a scaled point lies farther than
/// kFarthestPose from the origin, where no hair can be.
void scaleToMeters(std::span<Vec3> points, float unit_meters, const std::string& name);

}  // namespace strandcast
