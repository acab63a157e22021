#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/guide_packing.h"
#include "transport/messages.h"

namespace strandcast {

/// Whether all components of all vectors are finite: no NaN, no infinity.
template <class Vector>
bool allFinite(const std::vector<Vector>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const Vector& v) { return v.allFinite(); });
}

/// Whether all values are finite: no NaN, no infinity.
inline bool allFinite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

/// Messages cut into chunks that fit a datagram and can each be understood alone. They are the same for every
/// transport; idl/strandcast.idl describes the fields. An assembler (transport/assembler.h) must check every
/// number of a received chunk before it is used.

inline constexpr size_t kMaxChunkBytes = 60000;   ///< of arrays in one chunk
inline constexpr uint32_t kMaxChunks = 4096;      ///< of one message
inline constexpr size_t kMaxWireVertices = 3500;  ///< per strand: a strand is never divided between chunks
inline constexpr size_t kMaxTextBytes = 255;      ///< of every name on the wire
inline constexpr size_t kMaxCommandValues = 64;   ///< numbers of one command

/// Size of the arrays of one chunk.
template <class... T>
size_t bytesOf(const std::vector<T>&... arrays) {
  return (... + (sizeof(T) * arrays.size()));
}

/// Cut to kMaxTextBytes.
inline std::string shortened(const std::string& text) { return text.substr(0, kMaxTextBytes); }

inline constexpr uint32_t kMaxWriters = 1024;  ///< processes that write one frame

/// How GuideChunk::payload encodes positions: docs/wire.md, "Payloads". Received numbers may be others.
enum class Encoding : uint32_t {
  kFloat32 = 0,
  kDelta16 = 1,
  kOctahedral12 = 2,
  kOctahedral16 = 3,
  kTangent = 5  ///< 4, with other codes, is no longer read
};

/// A part of a groom: whole strands. Fields: docs/wire.md, "GroomChunk". Positions in m, groom frame.
struct GroomChunk {
  enum Arrays : uint32_t { kPinned = 1, kRadii = 2, kUvs = 4, kParts = 8, kSeeded = 16, kIds = 32 };
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_strands = 0, total_vertices = 0, first_strand = 0, first_vertex = 0;
  uint32_t growth = GroomDescription::kFromSeed;  ///< bits of GroomDescription::Growth
  float hair_radius = 0;
  uint32_t arrays = 0;  ///< bits of Arrays
  std::string name;
  std::vector<uint32_t> vertex_counts;  ///< per strand of the chunk
  std::vector<float> positions;         ///< 3 per vertex
  std::vector<uint8_t> pinned;          ///< per vertex or empty
  std::vector<float> radii;             ///< per vertex or empty
  std::vector<float> uvs;               ///< 2 per strand or empty
  std::vector<uint16_t> parts;          ///< per strand or empty
  std::vector<uint8_t> seeded;          ///< per strand or empty
  std::vector<uint32_t> ids;            ///< per strand or empty
};

/// A part of the hairs that follow a groom's guides: whole hairs. Fields: docs/wire.md, "Hairs".
struct HairChunk {
  enum Arrays : uint32_t { kRadii = 1, kUvs = 2, kColours = 4, kParts = 8, kIds = 16 };
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_hairs = 0, total_vertices = 0, first_hair = 0, first_vertex = 0;
  uint32_t hair_count = 0, vertex_count = 0;
  uint32_t arrays = 0;  ///< bits of Arrays
  uint32_t encoding = 0;
  float step = 0;                 ///< m, of the grid of positions
  float radius_step = 0;          ///< m
  std::array<float, 4> uv_box{};  ///< lowest u, v; size in u, v
  std::vector<uint8_t> payload;
};

/// A part of a body: positions, triangles or both. Fields: docs/wire.md, "BodyChunk".
struct BodyChunk {
  enum Arrays : uint32_t { kNormals = 1, kHeadWeights = 2 };
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_positions = 0, total_triangles = 0, first_position = 0, first_triangle = 0;
  uint32_t arrays = 0;  ///< bits of Arrays
  std::string name;
  std::vector<float> positions;     ///< 3 per position of the chunk
  std::vector<float> normals;       ///< 3 per position or empty
  std::vector<float> head_weights;  ///< per position or empty
  std::vector<uint32_t> triangles;  ///< 3 per triangle of the chunk
};

/// Fields: docs/wire.md, "ColliderChunk". Made by transport/chunks.h.
struct ColliderChunk {
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_shapes = 0, total_words = 0, first_shape = 0, first_word = 0;
  std::vector<uint32_t> colliders;    ///< per shape: id of its collider
  std::vector<uint32_t> word_counts;  ///< per shape: how many of the words belong to it
  std::vector<float> numbers;         ///< 16 per shape
  std::vector<uint8_t> kinds;         ///< per shape: PrimitiveKind
  std::vector<uint8_t> follows_head;  ///< per shape: 0 or 1
  std::vector<uint32_t> words;
};

inline constexpr size_t kBendNumbers = 33;     ///< floats of a collider's bend
inline constexpr float kMaxBendNumber = 1e7f;  ///< bound on the magnitude of each

/// Visits the kBendNumbers numbers of a bend in the order of the wire: take(float&).
template <class Bend, class Take>
void bendNumbers(Bend& bend, const Take& take) {
  for (int c = 0; c < 3; ++c) take(bend.middle[c]);
  for (auto& term : bend.terms)
    for (int c = 0; c < 3; ++c) take(term[c]);
}

/// A part of a frame: whole strands. Fields: docs/wire.md, "GuideChunk".
struct GuideChunk {
  uint64_t session = 0, frame = 0, publish_time = 0, pose_source = 0, pose_time = 0;
  double simulation_time = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t first_strand = 0, strand_count = 0, first_vertex = 0, vertex_count = 0;
  uint32_t writer = 0, writers = 1;  ///< which of how many processes wrote this chunk
  uint32_t continuity = 0;
  std::array<float, 3> head_position{};
  std::array<float, 4> head_rotation{0, 0, 0, 1};
  uint64_t key_frame = 0;  ///< frame that the payload builds on; 0: it can be decoded alone
  Encoding encoding = Encoding::kFloat32;
  std::vector<uint32_t> colliders;       ///< in chunk 0, else empty: ids of those that do not follow the head
  std::vector<float> collider_poses;     ///< 7 each: position x y z, rotation x y z w
  std::vector<uint32_t> bent_colliders;  ///< those of them that are bent
  std::vector<float> collider_bends;     ///< kBendNumbers each: middle and terms of a SurfaceBend
  std::vector<uint8_t> payload;
};

/// Throws Error, naming `where`, on a description that a receiver would refuse: see Publisher::announce.
void checkAnnouncement(const GroomDescription& groom, const BodyDescription& body, const std::string& where);

/// Throws Error when `next` has the session of `last` (null: none) without a higher revision: readers would
/// keep `last`.
void checkSuccession(const GroomDescription* last, const GroomDescription& next);

/// Divides strands into consecutive runs that each take no more than kMaxChunkBytes, given the bytes per
/// strand and per vertex; `bytes_before` are taken in the first chunk already. A strand that exceeds the
/// limit has a chunk of its own. `offsets` as in StrandSet. Precondition: no strand has more than
/// kMaxWireVertices vertices.
std::vector<StrandRun> divideStrands(std::span<const uint32_t> offsets, size_t bytes_per_strand,
                                     size_t bytes_per_vertex, size_t bytes_before = 0);

/// The runs of a guide frame of this groom, one per chunk.
std::vector<StrandRun> divideGuides(const StrandSet& guides);

/// Precondition of both: checkAnnouncement() accepts the description.
std::vector<GroomChunk> splitGroom(const GroomDescription& groom);
std::vector<BodyChunk> splitBody(const BodyDescription& body);

/// Sets all fields of chunk `index` of `frame` but encoding, key_frame and payload, which
/// codec/guide_encoder.h sets. `runs` are those of divideGuides().
void fillGuideHeader(const GuideFrame& frame, std::span<const StrandRun> runs, uint32_t index,
                     GuideChunk& chunk);

/// At most kMaxTextBytes bytes, without control characters.
bool isSoundName(const std::string& name);
/// Whether a command fits the wire: known kind, id not 0, at most kMaxCommandValues, all finite,
/// isSoundName().
bool isSound(const Command& command);
/// Throws Error when `command` is not sound or is for another groom than `groom_id` (0 stands for it).
void checkCommand(const Command& command, uint32_t groom_id);
/// Throws Error on 0, which stands for a subscriber's own groom.
void checkGroomId(uint32_t groom_id, const char* where);

/// Colliders in chunks: docs/wire.md, "ColliderChunk". Shapes are in the first chunks; the data of convex
/// bodies and fields, as 32-bit words, in those after them.

inline constexpr size_t kMaxColliders = 1024;           ///< of a groom
inline constexpr size_t kMaxColliderShapes = 4096;      ///< of all colliders of a groom
inline constexpr uint64_t kMaxColliderWords = 8 << 20;  ///< of all colliders of a groom; 32 MB
inline constexpr size_t kShapeNumbers = 16;             ///< floats per shape
inline constexpr float kMaxShapeNumber = 1e7f;          ///< m; bound on the magnitude of each

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
