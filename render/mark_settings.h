#pragma once

namespace strandcast {

/// Diagnostic marks over a picture.
struct MarkSettings {
  bool guides = false;    ///< the guides' curves, one colour each
  bool tangents = false;  ///< of guides, 1 cm long; red, green and blue are the x, y and z components
  bool collided = false;  ///< vertices of guides that touch an obstacle: yellow, red inside
  bool inside = false;    ///< vertices of grown hair inside an obstacle (kCompute only)

  bool any() const { return guides || tangents || collided || inside; }
  bool needBodies() const { return collided || inside; }
  bool operator==(const MarkSettings&) const = default;
};

}  // namespace strandcast
