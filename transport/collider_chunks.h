#pragma once
#include <map>
#include <memory>
#include <vector>

#include "transport/chunks.h"

namespace strandcast {

/// Colliders in chunks: docs/wire.md, "ColliderChunk". Shapes are in the first chunks; the data of convex
/// bodies and fields, as 32-bit words, in those after them.

inline constexpr size_t kMaxColliders = 1024;           ///< of a groom
inline constexpr size_t kMaxColliderShapes = 4096;      ///< of all colliders of a groom
inline constexpr uint64_t kMaxColliderWords = 8 << 20;  ///< of all colliders of a groom; 32 MB
inline constexpr size_t kShapeNumbers = 16;             ///< floats per shape
inline constexpr float kMostShapeNumber = 1e7f;         ///< m; bound on the magnitude of each

/// Visits the kShapeNumbers numbers of a shape in the order of the wire: take(float&).
template <class Shape, class Take>
void shapeNumbers(Shape& shape, const Take& take) {
  for (int c = 0; c < 3; ++c) take(shape.a[c]);
  for (int c = 0; c < 3; ++c) take(shape.b[c]);
  take(shape.radius);
  take(shape.radius_b);
  take(shape.friction);
  for (int c = 0; c < 3; ++c) take(shape.extent[c]);
  for (int c = 0; c < 4; ++c) take(shape.rotation.coeffs()[c]);
}

/// Throw Error, naming `where`, on a shape or on colliders that a receiver would refuse.
void checkColliderShape(const ContactPrimitive& shape, const std::string& where);
void checkColliders(const ColliderSet& set, const std::string& where);
/// Precondition: checkColliders() accepts `set`. Fields that would exceed kMaxColliderWords, counted from the
/// first shape on, are sent without their words.
std::vector<ColliderChunk> splitColliders(const ColliderSet& set);

/// Whether the chunk's numbers are consistent.
bool isSoundAlone(const ColliderChunk& chunk);
/// Whether two chunks of one session and revision have the same chunk count and totals.
bool agree(const ColliderChunk& a, const ColliderChunk& b);
/// Null unless the chunks are consecutive and make up valid colliders.
std::shared_ptr<const ColliderSet> build(const std::map<uint32_t, ColliderChunk>& chunks);

}  // namespace strandcast
