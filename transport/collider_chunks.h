#pragma once
#include <map>
#include <memory>
#include <vector>

#include "transport/chunks.h"

namespace strandcast {

/// Colliders in pieces: docs/wire.md, "ColliderChunk". Shapes fill the first chunks; what convex bodies and
/// fields consist of, as 32-bit words, those behind them.

inline constexpr size_t kMaxColliders = 1024;           ///< of a groom
inline constexpr size_t kMaxColliderShapes = 4096;      ///< of all
inline constexpr uint64_t kMaxColliderWords = 8 << 20;  ///< of all; 32 MB
inline constexpr size_t kShapeNumbers = 16;             ///< floats of a shape
inline constexpr float kMostShapeNumber = 1e7f;         ///< m; of all of them, either sign

/// Goes through the kShapeNumbers of a shape in the order of the wire: take(float&).
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

/// Throw Error, naming `where`, on a shape and on colliders that a receiver would refuse.
void checkColliderShape(const ContactPrimitive& shape, const std::string& where);
void checkColliders(const ColliderSet& set, const std::string& where);
/// Of what checkColliders accepts. Fields that would take more words than there may be, together with those
/// before them, are told of without their words.
std::vector<ColliderChunk> splitColliders(const ColliderSet& set);

/// Whether the chunk's numbers fit each other.
bool isSoundAlone(const ColliderChunk& chunk);
bool agree(const ColliderChunk& a, const ColliderChunk& b);
/// Null unless the chunks follow each other and make up sound colliders.
std::shared_ptr<const ColliderSet> build(const std::map<uint32_t, ColliderChunk>& chunks);

}  // namespace strandcast
