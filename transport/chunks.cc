#include "transport/chunks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "core/error.h"

namespace strandcast {
namespace {

static_assert(sizeof(Vec3) == 12, "positions are copied as three floats");
static_assert(sizeof(Vec2) == 8, "uvs are copied as two floats");
static_assert(std::endian::native == std::endian::little, "the float32 encoding is little-endian");

/// Copies `count` vectors from `first` on as floats.
template <class Vector>
std::vector<float> floats(const std::vector<Vector>& vectors, size_t first, size_t count) {
  constexpr size_t kComponents = sizeof(Vector) / sizeof(float);
  std::vector<float> result(count * kComponents);
  if (count > 0) std::memcpy(result.data(), vectors.data() + first, count * sizeof(Vector));
  return result;
}

/// Copies a slice of an array that may be absent.
template <class T>
std::vector<T> slice(const std::vector<T>& values, size_t first, size_t count) {
  if (values.empty()) return {};
  const auto begin = values.begin() + static_cast<ptrdiff_t>(first);
  return {begin, begin + static_cast<ptrdiff_t>(count)};
}

void require(bool holds, const char* what, const std::string& where, const char* remedy) {
  if (!holds) throw Error(what, where, remedy);
}

void checkGroom(const GroomDescription& groom, const std::string& where) {
  const StrandSet& guides = groom.guides;
  checkStrandSet(guides, where);
  require(guides.strands() > 0, "the groom has no strands", where, "load a groom with at least one strand");
  for (size_t s = 0; s < guides.strands(); ++s) {
    if (guides.verticesOf(s) > kMaxWireVertices) {
      throw Error("strand " + std::to_string(s) + " has " + std::to_string(guides.verticesOf(s)) +
                      " vertices, more than the " + std::to_string(kMaxWireVertices) +
                      " of one network chunk",
                  where, "resample it to fewer vertices");
    }
  }
  const auto fits = [&](size_t size) { return size == 0 || size == guides.strands(); };
  require(fits(groom.seeded.size()) && fits(groom.ids.size()), "an array of the groom has the wrong length",
          where, "");
  require(groom.growth >= 1 && groom.growth < 8, "the groom does not say what is drawn", where,
          "give a sum of GroomDescription::Growth");
  require(isHairRadius(groom.hair_radius), "the hair's radius is not in 0 to 0.01 m", where,
          "give it in metres");
}

void checkBody(const BodyDescription& body, const std::string& where) {
  const TriangleMesh& mesh = body.mesh;
  const auto fits = [&](size_t size) { return size == 0 || size == mesh.positions.size(); };
  require(fits(mesh.normals.size()) && fits(body.head_weights.size()),
          "an array of the body has the wrong length", where, "");
  require(allFinite(mesh.positions) && allFinite(mesh.normals) && allFinite(body.head_weights),
          "the body has a number that is not finite", where, "clean the mesh up first");
  require(std::all_of(body.head_weights.begin(), body.head_weights.end(),
                      [](float w) { return w >= 0 && w <= 1; }),
          "a head weight of the body is not in 0 to 1", where, "");
  for (const auto& triangle : mesh.triangles) {
    require(*std::max_element(triangle.begin(), triangle.end()) < mesh.positions.size(),
            "a triangle of the body names a position that is not there", where, "clean the mesh up first");
  }
}

/// Bytes of a groom's chunk per strand, without those of arrays that few grooms have.
constexpr size_t kGroomBytesPerStrand = 4 + 8 + 2;
constexpr size_t kGroomBytesPerVertex = 12 + 1 + 4;
constexpr size_t kGuideBytesPerVertex = 12;
/// Most bytes in chunk 0 of a frame: ids and poses, ids and bends.
constexpr size_t kColliderBytes = kMaxPlacedColliders * (4 + 4 * 7 + 4 + 4 * kBendNumbers);
constexpr size_t kPositionsPerBodyChunk = kMaxChunkBytes / (12 + 12 + 4);
constexpr size_t kTrianglesPerBodyChunk = kMaxChunkBytes / 12;

size_t chunksFor(size_t count, size_t per_chunk) { return (count + per_chunk - 1) / per_chunk; }

std::vector<StrandRun> divideGroom(const GroomDescription& groom) {
  const size_t bytes_per_strand =
      kGroomBytesPerStrand + (groom.seeded.empty() ? 0 : 1) + (groom.ids.empty() ? 0 : 4);
  return divideStrands(groom.guides.offsets, bytes_per_strand, kGroomBytesPerVertex);
}

}  // namespace

void checkAnnouncement(const GroomDescription& groom, const BodyDescription& body, const std::string& where) {
  checkGroom(groom, where);
  checkBody(body, where);
  const size_t body_chunks = chunksFor(body.mesh.positions.size(), kPositionsPerBodyChunk) +
                             chunksFor(body.mesh.triangles.size(), kTrianglesPerBodyChunk);
  const size_t groom_chunks = divideGroom(groom).size();
  require(groom_chunks <= kMaxChunks, "the groom is too large for the network", where,
          "publish fewer guides");
  require(body_chunks <= kMaxChunks, "the body is too large for the network", where, "use a coarser mesh");
}

void checkSuccession(const GroomDescription* last, const GroomDescription& next) {
  require(!last || last->session != next.session || last->revision < next.revision,
          "the groom was announced before in this revision", "groom " + next.name, "count its revision up");
}

std::vector<StrandRun> divideStrands(std::span<const uint32_t> offsets, size_t bytes_per_strand,
                                     size_t bytes_per_vertex, size_t bytes_before) {
  std::vector<StrandRun> runs;
  size_t bytes = kMaxChunkBytes + 1;  // full, so that the first strand opens a run
  for (uint32_t s = 0; s + 1 < offsets.size(); ++s) {
    const uint32_t vertices = offsets[s + 1] - offsets[s];
    const size_t needed = bytes_per_strand + bytes_per_vertex * vertices;
    if (bytes + needed > kMaxChunkBytes) {
      bytes = runs.empty() ? bytes_before : 0;
      runs.push_back({s, 0, offsets[s], 0});
    }
    bytes += needed;
    ++runs.back().strand_count;
    runs.back().vertex_count += vertices;
  }
  return runs;
}

std::vector<StrandRun> divideGuides(const StrandSet& guides) {
  return divideStrands(guides.offsets, 0, kGuideBytesPerVertex, kColliderBytes);
}

std::vector<GroomChunk> splitGroom(const GroomDescription& groom) {
  const StrandSet& guides = groom.guides;
  const std::vector<StrandRun> runs = divideGroom(groom);
  std::vector<GroomChunk> chunks(runs.size());
  for (uint32_t i = 0; i < runs.size(); ++i) {
    const StrandRun& run = runs[i];
    GroomChunk& chunk = chunks[i];
    chunk.session = groom.session;
    chunk.groom_id = groom.groom_id;
    chunk.chunk_index = i;
    chunk.chunk_count = static_cast<uint32_t>(runs.size());
    chunk.revision = groom.revision;
    chunk.total_strands = static_cast<uint32_t>(guides.strands());
    chunk.total_vertices = static_cast<uint32_t>(guides.vertices());
    chunk.first_strand = run.first_strand;
    chunk.first_vertex = run.first_vertex;
    chunk.growth = groom.growth;
    chunk.hair_radius = groom.hair_radius;
    chunk.arrays =
        (guides.pinned.empty() ? 0u : GroomChunk::kPinned) |
        (guides.radii.empty() ? 0u : GroomChunk::kRadii) | (guides.uvs.empty() ? 0u : GroomChunk::kUvs) |
        (guides.parts.empty() ? 0u : GroomChunk::kParts) | (groom.seeded.empty() ? 0u : GroomChunk::kSeeded) |
        (groom.ids.empty() ? 0u : GroomChunk::kIds);
    chunk.name = shortened(groom.name);
    chunk.vertex_counts.resize(run.strand_count);
    for (uint32_t s = 0; s < run.strand_count; ++s) {
      chunk.vertex_counts[s] = static_cast<uint32_t>(guides.verticesOf(run.first_strand + s));
    }
    chunk.positions = floats(guides.positions, run.first_vertex, run.vertex_count);
    chunk.pinned = slice(guides.pinned, run.first_vertex, run.vertex_count);
    chunk.radii = slice(guides.radii, run.first_vertex, run.vertex_count);
    if (!guides.uvs.empty()) chunk.uvs = floats(guides.uvs, run.first_strand, run.strand_count);
    chunk.parts = slice(guides.parts, run.first_strand, run.strand_count);
    chunk.seeded = slice(groom.seeded, run.first_strand, run.strand_count);
    chunk.ids = slice(groom.ids, run.first_strand, run.strand_count);
  }
  return chunks;
}

std::vector<BodyChunk> splitBody(const BodyDescription& body) {
  const TriangleMesh& mesh = body.mesh;
  const size_t position_chunks = chunksFor(mesh.positions.size(), kPositionsPerBodyChunk);
  const size_t triangle_chunks = chunksFor(mesh.triangles.size(), kTrianglesPerBodyChunk);
  std::vector<BodyChunk> chunks(std::max<size_t>(1, position_chunks + triangle_chunks));
  for (size_t i = 0; i < chunks.size(); ++i) {
    // Positions fill the first chunks, triangles those after them.
    const size_t first_position = std::min(i * kPositionsPerBodyChunk, mesh.positions.size());
    const size_t positions = std::min(kPositionsPerBodyChunk, mesh.positions.size() - first_position);
    const size_t triangle_slot = i < position_chunks ? 0 : i - position_chunks;
    const size_t first_triangle = std::min(triangle_slot * kTrianglesPerBodyChunk, mesh.triangles.size());
    const size_t triangles =
        i < position_chunks ? 0 : std::min(kTrianglesPerBodyChunk, mesh.triangles.size() - first_triangle);
    BodyChunk& chunk = chunks[i];
    chunk.session = body.session;
    chunk.groom_id = body.groom_id;
    chunk.chunk_index = static_cast<uint32_t>(i);
    chunk.chunk_count = static_cast<uint32_t>(chunks.size());
    chunk.revision = body.revision;
    chunk.total_positions = static_cast<uint32_t>(mesh.positions.size());
    chunk.total_triangles = static_cast<uint32_t>(mesh.triangles.size());
    chunk.first_position = static_cast<uint32_t>(first_position);
    chunk.first_triangle = static_cast<uint32_t>(first_triangle);
    chunk.arrays = (mesh.normals.empty() ? 0u : BodyChunk::kNormals) |
                   (body.head_weights.empty() ? 0u : BodyChunk::kHeadWeights);
    chunk.name = shortened(mesh.name);
    chunk.positions = floats(mesh.positions, first_position, positions);
    if (!mesh.normals.empty()) chunk.normals = floats(mesh.normals, first_position, positions);
    chunk.head_weights = slice(body.head_weights, first_position, positions);
    chunk.triangles.reserve(triangles * 3);
    for (size_t t = first_triangle; t < first_triangle + triangles; ++t) {
      chunk.triangles.insert(chunk.triangles.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
  }
  return chunks;
}

void fillGuideHeader(const GuideFrame& frame, std::span<const StrandRun> runs, uint32_t index,
                     GuideChunk& chunk) {
  const StrandRun& run = runs[index];
  chunk.session = frame.session;
  chunk.frame = frame.frame;
  chunk.publish_time = frame.publish_time;
  chunk.pose_source = frame.pose_source;
  chunk.pose_time = frame.pose_time;
  chunk.continuity = frame.continuity;
  chunk.simulation_time = frame.simulation_time;
  chunk.groom_id = frame.groom_id;
  chunk.chunk_index = index;
  chunk.chunk_count = static_cast<uint32_t>(runs.size());
  chunk.revision = frame.revision;
  chunk.first_strand = run.first_strand;
  chunk.strand_count = run.strand_count;
  chunk.first_vertex = run.first_vertex;
  chunk.vertex_count = run.vertex_count;
  for (int k = 0; k < 3; ++k) chunk.head_position[static_cast<size_t>(k)] = frame.head.position[k];
  for (int k = 0; k < 4; ++k) chunk.head_rotation[static_cast<size_t>(k)] = frame.head.rotation.coeffs()[k];
  chunk.colliders.clear();
  chunk.collider_poses.clear();
  chunk.bent_colliders.clear();
  chunk.collider_bends.clear();
  const size_t placed = index == 0 ? std::min(frame.colliders.size(), kMaxPlacedColliders) : 0;
  for (size_t i = 0; i < placed; ++i) {
    const auto& [id, pose, bend] = frame.colliders[i];
    chunk.colliders.push_back(id);
    for (int k = 0; k < 3; ++k) chunk.collider_poses.push_back(pose.position[k]);
    for (int k = 0; k < 4; ++k) chunk.collider_poses.push_back(pose.rotation.coeffs()[k]);
    if (bend.isNone()) continue;
    chunk.bent_colliders.push_back(id);
    bendNumbers(bend, [&](float number) { chunk.collider_bends.push_back(number); });
  }
}

bool isSoundName(const std::string& name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return name.size() <= kMaxTextBytes && std::none_of(name.begin(), name.end(), is_control);
}

bool isSound(const Command& command) {
  return command.id != 0 && command.kind <= CommandKind::kAddColliderFile && isSoundName(command.name) &&
         command.values.size() <= kMaxCommandValues &&
         std::all_of(command.values.begin(), command.values.end(), [](double v) { return std::isfinite(v); });
}

void checkCommand(const Command& command, uint32_t groom_id) {
  const std::string where = "command to groom " + std::to_string(groom_id);
  constexpr size_t kShown = 40;  // bytes of a long name that an error shows
  const std::string& name = command.name;
  if (name.size() > kMaxTextBytes)
    throw Error("the name is too long: " + std::to_string(name.size()) + " bytes",
                where + ", name '" + name.substr(0, kShown) + "...'",
                "give one of at most " + std::to_string(kMaxTextBytes) + " bytes");
  require(isSoundName(name), "the name has a line break or another control character", where,
          "give one of one line");
  require(isSound(command), "the command does not fit the wire", where,
          "give it an id other than 0, a known kind and at most 64 finite values");
  require(command.groom_id == 0 || command.groom_id == groom_id, "the command is for another groom", where,
          "use a subscriber of that groom");
}

void checkGroomId(uint32_t groom_id, const char* where) {
  require(groom_id != 0, "the groom id is 0", where, "choose 1 or more");
}

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
  return std::all_of(numbers.begin(), numbers.end(), [](float n) { return std::abs(n) <= kMaxShapeNumber; });
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
    if (!(std::abs(number) <= kMaxShapeNumber))
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
