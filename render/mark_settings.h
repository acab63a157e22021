#pragma once

namespace strandcast {

/// What a picture shows for those who look for faults.
struct MarkSettings {
  bool guides = false;    ///< the guides' curves, a colour each
  bool tangents = false;  ///< of guides, 1 cm long; red, green, blue as they lie along x, y, z
  bool collided = false;  ///< vertices of guides that touch an obstacle: yellow, red inside
  bool inside = false;    ///< vertices of grown hair inside an obstacle (kCompute only)

  bool any() const { return guides || tangents || collided || inside; }
  bool needBodies() const { return collided || inside; }
  bool operator==(const MarkSettings&) const = default;
};

}  // namespace strandcast
