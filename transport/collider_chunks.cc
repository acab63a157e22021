#include "transport/collider_chunks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "core/error.h"

namespace strandcast {
namespace {

constexpr size_t kBytesPerShape = 4 + 1 + 1 + 4 + 4 * kShapeNumbers;
constexpr size_t kShapesPerChunk = kMaxChunkBytes / kBytesPerShape;
constexpr size_t kWordsPerChunk = kMaxChunkBytes / 4;
constexpr size_t kGridWords = 9, kBoxWords = 6, kPlaneWords = 4, kMaxPlanes = 1024;

size_t wordsOf(const ContactPrimitive& shape) {
  if (shape.kind == PrimitiveKind::kConvex) return kBoxWords + kPlaneWords * shape.convex->planes.size();
  if (shape.kind != PrimitiveKind::kField) return 0;
  return kGridWords + shape.field->index.size() + shape.field->samples.size() + shape.field->corners.size();
}

template <class Numbers>
void putFloats(const Numbers& numbers, std::vector<uint32_t>& words) {
  for (const float number : numbers) words.push_back(std::bit_cast<uint32_t>(number));
}

void putWords(const ContactPrimitive& shape, std::vector<uint32_t>& words) {
  if (shape.kind == PrimitiveKind::kConvex) {
    for (const auto& corner : {shape.convex->bounds.min(), shape.convex->bounds.max()})
      for (int c = 0; c < 3; ++c) words.push_back(std::bit_cast<uint32_t>(corner[c]));
    for (const auto& plane : shape.convex->planes) putFloats(plane, words);
    return;
  }
  const FieldGrid& grid = shape.field->grid;
  putFloats(grid.origin, words);
  words.push_back(std::bit_cast<uint32_t>(grid.cell));
  words.insert(words.end(), std::begin(grid.bricks), std::end(grid.bricks));
  words.push_back(std::bit_cast<uint32_t>(grid.band));
  words.push_back(std::bit_cast<uint32_t>(grid.quantum));
  words.insert(words.end(), shape.field->index.begin(), shape.field->index.end());
  words.insert(words.end(), shape.field->samples.begin(), shape.field->samples.end());
  putFloats(shape.field->corners, words);
}

/// Finite, and so small that squared distances do not overflow a float.
bool isFinite(std::span<const float> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float n) { return std::abs(n) <= kMostShapeNumber; });
}

std::vector<float> floatsOf(std::span<const uint32_t> words) {
  std::vector<float> numbers(words.size());
  if (!words.empty()) std::memcpy(numbers.data(), words.data(), words.size_bytes());
  return numbers;
}

std::shared_ptr<const ConvexBody> convexOf(std::span<const uint32_t> words) {
  if (words.size() < kBoxWords + 4 * kPlaneWords || (words.size() - kBoxWords) % kPlaneWords != 0 ||
      words.size() > kBoxWords + kMaxPlanes * kPlaneWords)
    return nullptr;
  const std::vector<float> numbers = floatsOf(words);
  if (!isFinite(numbers)) return nullptr;
  auto body = std::make_shared<ConvexBody>();
  for (int c = 0; c < 3; ++c) {
    const size_t k = static_cast<size_t>(c);
    if (numbers[k] > numbers[3 + k]) return nullptr;
    body->bounds.min()[c] = numbers[k];
    body->bounds.max()[c] = numbers[3 + k];
  }
  for (size_t at = kBoxWords; at < numbers.size(); at += kPlaneWords) {
    const Vec3 normal(numbers[at], numbers[at + 1], numbers[at + 2]);
    if (!(std::abs(normal.norm() - 1) < 1e-3f)) return nullptr;
    body->planes.push_back({normal.x(), normal.y(), normal.z(), numbers[at + 3]});
  }
  return body;
}

bool isSound(const FieldGrid& grid) {
  const auto in_range = [](float value, float low, float high) { return value >= low && value <= high; };
  uint64_t corners = 1;
  for (const uint32_t bricks : grid.bricks) {
    corners *= uint64_t{bricks} + 1;
    if (bricks == 0 || corners > kMaxGridBricks) return false;
  }
  return in_range(grid.origin[0], -1e7f, 1e7f) && in_range(grid.origin[1], -1e7f, 1e7f) &&
         in_range(grid.origin[2], -1e7f, 1e7f) && in_range(grid.cell, 1e-6f, 1e3f) &&
         in_range(grid.band, grid.cell, 1001 * grid.cell) &&
         in_range(grid.quantum, 1e-6f * grid.cell, grid.cell);
}

std::shared_ptr<const DistanceField> fieldOf(std::span<const uint32_t> words) {
  if (words.size() < kGridWords) return nullptr;
  auto field = std::make_shared<DistanceField>();
  FieldGrid& grid = field->grid;
  std::memcpy(grid.origin, words.data(), 3 * sizeof(float));
  grid.cell = std::bit_cast<float>(words[3]);
  std::memcpy(grid.bricks, words.data() + 4, 3 * sizeof(uint32_t));
  grid.band = std::bit_cast<float>(words[7]);
  grid.quantum = std::bit_cast<float>(words[8]);
  if (!isSound(grid)) return nullptr;
  words = words.subspan(kGridWords);
  const size_t bricks = size_t{grid.bricks[0]} * grid.bricks[1] * grid.bricks[2];
  const size_t corners = (size_t{grid.bricks[0]} + 1) * (grid.bricks[1] + 1) * (grid.bricks[2] + 1);
  if (words.size() < bricks + corners || (words.size() - bricks - corners) % kBrickWords != 0) return nullptr;
  field->index.assign(words.begin(), words.begin() + static_cast<ptrdiff_t>(bricks));
  field->samples.assign(words.begin() + static_cast<ptrdiff_t>(bricks),
                        words.end() - static_cast<ptrdiff_t>(corners));
  field->corners = floatsOf(words.last(corners));
  const size_t stored = field->storedBricks();
  // Bricks are stored in the order of the index.
  size_t next = 0;
  for (const uint32_t entry : field->index) {
    if (entry == kOutsideBrick || entry == kInsideBrick) continue;
    if (entry != next++ || next > stored) return nullptr;
  }
  const bool is_near = std::all_of(field->corners.begin(), field->corners.end(),
                                   [](float distance) { return std::abs(distance) < 1e7f; });
  return next == stored && is_near ? field : nullptr;
}

/// False where a shape is invalid; a shape whose field was not sent is skipped.
bool addShape(const ColliderChunk& chunk, size_t i, std::span<const uint32_t> words, Collider& to) {
  ContactPrimitive shape;
  const float* number = chunk.numbers.data() + i * kShapeNumbers;
  shapeNumbers(shape, [&](float& into) { into = *number++; });
  shape.kind = static_cast<PrimitiveKind>(chunk.kinds[i]);
  if (shape.kind == PrimitiveKind::kConvex) shape.convex = convexOf(words);
  if (shape.kind == PrimitiveKind::kField) {
    if (words.empty()) {
      to.is_whole = false;
      return true;
    }
    shape.field = fieldOf(words);
  }
  try {
    checkPrimitive(shape, "");
  } catch (const Error&) {
    return false;
  }
  to.shapes.push_back(std::move(shape));
  return true;
}

}  // namespace

void checkColliderShape(const ContactPrimitive& shape, const std::string& where) {
  checkPrimitive(shape, where);
  shapeNumbers(shape, [&](float number) {
    if (!(std::abs(number) <= kMostShapeNumber))
      throw Error("a collider is beyond 10,000 km", where, "give it in metres");
  });
}

void checkColliders(const ColliderSet& set, const std::string& where) {
  size_t shapes = 0;
  std::set<uint32_t> ids;
  for (const Collider& collider : set.colliders) {
    shapes += collider.shapes.size();
    for (const ContactPrimitive& shape : collider.shapes) checkColliderShape(shape, where);
    if (!ids.insert(collider.id).second) throw Error("two colliders have one id", where, "number them");
    if (collider.shapes.empty()) throw Error("a collider has no shape", where, "leave it out");
  }
  if (set.colliders.size() > kMaxColliders || shapes > kMaxColliderShapes)
    throw Error("there are too many colliders for the network", where,
                "cast at most " + std::to_string(kMaxColliders) + ", of " +
                    std::to_string(kMaxColliderShapes) + " shapes");
}

std::vector<ColliderChunk> splitColliders(const ColliderSet& set) {
  ColliderChunk all;  // fields common to all chunks
  all.session = set.session;
  all.groom_id = set.groom_id;
  all.revision = set.revision;
  std::vector<uint32_t> words;
  ColliderChunk shapes;
  for (const Collider& collider : set.colliders) {
    for (const ContactPrimitive& shape : collider.shapes) {
      const size_t needed = wordsOf(shape);
      const bool is_sent = words.size() + needed <= kMaxColliderWords;
      shapes.colliders.push_back(collider.id);
      shapes.follows_head.push_back(collider.follows_head ? 1 : 0);
      shapes.kinds.push_back(static_cast<uint8_t>(shape.kind));
      shapes.word_counts.push_back(static_cast<uint32_t>(is_sent ? needed : 0));
      shapeNumbers(shape, [&](const float& number) { shapes.numbers.push_back(number); });
      if (is_sent && needed > 0) putWords(shape, words);
    }
  }
  const size_t count = shapes.colliders.size();
  all.total_shapes = static_cast<uint32_t>(count);
  all.total_words = static_cast<uint32_t>(words.size());
  std::vector<ColliderChunk> chunks;
  const auto part = [](const auto& of, size_t first, size_t length) {
    const auto begin = of.begin() + static_cast<ptrdiff_t>(first);
    return std::decay_t<decltype(of)>(begin, begin + static_cast<ptrdiff_t>(length));
  };
  for (size_t first = 0; first < count || chunks.empty(); first += kShapesPerChunk) {
    const size_t length = std::min(kShapesPerChunk, count - first);
    ColliderChunk& chunk = chunks.emplace_back(all);
    chunk.first_shape = static_cast<uint32_t>(first);
    chunk.colliders = part(shapes.colliders, first, length);
    chunk.follows_head = part(shapes.follows_head, first, length);
    chunk.kinds = part(shapes.kinds, first, length);
    chunk.word_counts = part(shapes.word_counts, first, length);
    chunk.numbers = part(shapes.numbers, kShapeNumbers * first, kShapeNumbers * length);
  }
  for (size_t first = 0; first < words.size(); first += kWordsPerChunk) {
    ColliderChunk& chunk = chunks.emplace_back(all);
    chunk.first_shape = all.total_shapes;
    chunk.first_word = static_cast<uint32_t>(first);
    chunk.words = part(words, first, std::min(kWordsPerChunk, words.size() - first));
  }
  for (size_t i = 0; i < chunks.size(); ++i) {
    chunks[i].chunk_index = static_cast<uint32_t>(i);
    chunks[i].chunk_count = static_cast<uint32_t>(chunks.size());
  }
  return chunks;
}

bool isSoundAlone(const ColliderChunk& chunk) {
  const size_t shapes = chunk.colliders.size();
  return bytesOf(chunk.colliders, chunk.word_counts, chunk.numbers, chunk.kinds, chunk.follows_head,
                 chunk.words) <= kMaxChunkBytes &&
         chunk.session != 0 && chunk.chunk_count >= 1 && chunk.chunk_count <= kMaxChunks &&
         chunk.chunk_index < chunk.chunk_count && chunk.total_shapes <= kMaxColliderShapes &&
         chunk.total_words <= kMaxColliderWords && chunk.first_shape <= chunk.total_shapes &&
         shapes <= chunk.total_shapes - chunk.first_shape && chunk.first_word <= chunk.total_words &&
         chunk.words.size() <= chunk.total_words - chunk.first_word && chunk.follows_head.size() == shapes &&
         chunk.kinds.size() == shapes && chunk.word_counts.size() == shapes &&
         chunk.numbers.size() == kShapeNumbers * shapes && isFinite(chunk.numbers) &&
         std::all_of(chunk.kinds.begin(), chunk.kinds.end(),
                     [](uint8_t kind) { return kind <= static_cast<uint8_t>(PrimitiveKind::kField); });
}

bool agree(const ColliderChunk& a, const ColliderChunk& b) {
  return a.chunk_count == b.chunk_count && a.total_shapes == b.total_shapes && a.total_words == b.total_words;
}

std::shared_ptr<const ColliderSet> build(const std::map<uint32_t, ColliderChunk>& chunks) {
  const ColliderChunk& first = chunks.begin()->second;
  std::vector<uint32_t> words;
  size_t shapes = 0;
  uint64_t promised = 0;
  for (const auto& [index, chunk] : chunks) {
    if (chunk.first_shape != shapes || chunk.first_word != words.size()) return nullptr;
    shapes += chunk.colliders.size();
    for (const uint32_t count : chunk.word_counts) promised += count;
    words.insert(words.end(), chunk.words.begin(), chunk.words.end());
  }
  if (shapes != first.total_shapes || words.size() != first.total_words || promised != words.size())
    return nullptr;
  auto set = std::make_shared<ColliderSet>();
  set->groom_id = first.groom_id;
  set->session = first.session;
  set->revision = first.revision;
  std::set<uint32_t> known;
  size_t at = 0;
  for (const auto& [index, chunk] : chunks) {
    for (size_t i = 0; i < chunk.colliders.size(); ++i) {
      const uint32_t id = chunk.colliders[i];
      const bool follows_head = chunk.follows_head[i] != 0;
      // The shapes of one collider are consecutive.
      if (set->colliders.empty() || set->colliders.back().id != id) {
        if (!known.insert(id).second || set->colliders.size() == kMaxColliders) return nullptr;
        set->colliders.push_back({id, follows_head, true, {}});
      }
      Collider& collider = set->colliders.back();
      const std::span<const uint32_t> own(words.data() + at, chunk.word_counts[i]);
      at += own.size();
      if (collider.follows_head != follows_head || !addShape(chunk, i, own, collider)) return nullptr;
    }
  }
  return set;
}

}  // namespace strandcast
