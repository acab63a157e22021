#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// Messages cut into pieces that fit a datagram and can each be understood alone. The same for every
/// transport; the fields are described in idl/strandcast.idl. Numbers of a chunk that came from outside are
/// worth nothing until an assembler (transport/assembler.h) has checked them.

inline constexpr size_t kMaxChunkBytes = 60000;   ///< of arrays in one chunk
inline constexpr uint32_t kMaxChunks = 4096;      ///< of one message
inline constexpr size_t kMaxWireVertices = 3500;  ///< of a strand, which is not divided between chunks
inline constexpr size_t kMaxTextBytes = 255;      ///< of every name on the wire

/// Of the arrays of one chunk, together.
template <class... T>
size_t bytesOf(const std::vector<T>&... arrays) {
  return (... + (sizeof(T) * arrays.size()));
}

/// Cut to what the wire takes.
inline std::string shortened(const std::string& text) { return text.substr(0, kMaxTextBytes); }

/// How GuideChunk::payload holds positions: docs/wire.md.
enum class Encoding : uint32_t {
  kFloat32 = 0,
  kDelta16 = 1,
  kOctahedral12 = 2,
  kOctahedral16 = 3,
  kTangent = 5  ///< 4 was the same with other codes
};

struct GroomChunk {
  enum Arrays : uint32_t { kPinned = 1, kRadii = 2, kUvs = 4, kParts = 8 };
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_strands = 0, total_vertices = 0, first_strand = 0, first_vertex = 0;
  float hair_radius = 0;
  uint32_t arrays = 0;  ///< of Arrays
  std::string name;
  std::vector<uint32_t> vertex_counts;  ///< per strand of the chunk
  std::vector<float> positions;         ///< 3 per vertex
  std::vector<uint8_t> pinned;          ///< per vertex or empty
  std::vector<float> radii;             ///< per vertex or empty
  std::vector<float> uvs;               ///< 2 per strand or empty
  std::vector<uint16_t> parts;          ///< per strand or empty
};

struct BodyChunk {
  enum Arrays : uint32_t { kNormals = 1, kHeadWeights = 2 };
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_positions = 0, total_triangles = 0, first_position = 0, first_triangle = 0;
  uint32_t arrays = 0;  ///< of Arrays
  std::string name;
  std::vector<float> positions;     ///< 3 per position of the chunk
  std::vector<float> normals;       ///< 3 per position or empty
  std::vector<float> head_weights;  ///< per position or empty
  std::vector<uint32_t> triangles;  ///< 3 per triangle of the chunk
};

/// transport/collider_chunks.h.
struct ColliderChunk {
  uint64_t session = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t total_shapes = 0, total_words = 0, first_shape = 0, first_word = 0;
  std::vector<uint32_t> colliders;    ///< per shape: the collider that it is of
  std::vector<uint32_t> word_counts;  ///< per shape
  std::vector<float> numbers;         ///< 16 per shape
  std::vector<uint8_t> kinds;         ///< per shape: PrimitiveKind
  std::vector<uint8_t> follows_head;  ///< per shape: 0 or 1
  std::vector<uint32_t> words;
};

inline constexpr size_t kBendNumbers = 33;      ///< floats of a collider's bend
inline constexpr float kMostBendNumber = 1e7f;  ///< of all of them, either sign

/// Goes through the kBendNumbers of a bend in the order of the wire: take(float&).
template <class Bend, class Take>
void bendNumbers(Bend& bend, const Take& take) {
  for (int c = 0; c < 3; ++c) take(bend.middle[c]);
  for (auto& term : bend.terms)
    for (int c = 0; c < 3; ++c) take(term[c]);
}

struct GuideChunk {
  uint64_t session = 0, frame = 0, publish_time = 0;
  double simulation_time = 0;
  uint32_t groom_id = 0, chunk_index = 0, chunk_count = 0, revision = 0;
  uint32_t first_strand = 0, strand_count = 0, first_vertex = 0, vertex_count = 0;
  std::array<float, 3> head_position{};
  std::array<float, 4> head_rotation{0, 0, 0, 1};
  uint64_t key_frame = 0;  ///< that the payload is a difference to; 0 = it can be decoded alone
  Encoding encoding = Encoding::kFloat32;
  std::vector<uint32_t> colliders;       ///< of chunk 0: that do not follow the head
  std::vector<float> collider_poses;     ///< 7 each: position x y z, rotation x y z w
  std::vector<uint32_t> bent_colliders;  ///< those of them that are bent
  std::vector<float> collider_bends;     ///< kBendNumbers each: middle and terms of a SurfaceBend
  std::vector<uint8_t> payload;
};

/// A run of whole strands: what one chunk holds.
struct StrandRun {
  uint32_t first_strand = 0, strand_count = 0, first_vertex = 0, vertex_count = 0;
};

/// Throws Error, naming `where`, on a description that a receiver would refuse: see Publisher::announce.
void checkAnnouncement(const GroomDescription& groom, const BodyDescription& body, const std::string& where);

/// Throws Error when `next` has the session of `last` (null: none) without a higher revision: readers would
/// keep `last`.
void checkSuccession(const GroomDescription* last, const GroomDescription& next);

/// Consecutive runs of strands that each take no more than kMaxChunkBytes, at so many bytes per strand and
/// per vertex, in the first chunk beside `bytes_before`; a strand that is longer has a chunk of its own.
/// `offsets` as in StrandSet, no strand longer than kMaxWireVertices.
std::vector<StrandRun> divideStrands(std::span<const uint32_t> offsets, size_t bytes_per_strand,
                                     size_t bytes_per_vertex, size_t bytes_before = 0);

/// The runs of a guide frame of this groom.
std::vector<StrandRun> divideGuides(const StrandSet& guides);

/// Both expect what checkAnnouncement accepts.
std::vector<GroomChunk> splitGroom(const GroomDescription& groom);
std::vector<BodyChunk> splitBody(const BodyDescription& body);

/// All of chunk `index` of `frame` but encoding, key_frame and payload (codec/guide_encoder.h does those).
/// `runs` of divideGuides.
void fillGuideHeader(const GuideFrame& frame, std::span<const StrandRun> runs, uint32_t index,
                     GuideChunk& chunk);

/// Of kMaxTextBytes at most, without control characters.
bool isSoundName(const std::string& name);
/// A command that fits the wire: known kind, id not 0, finite values, at most 64 of them, a short name of one
/// line.
bool isSound(const Command& command);
/// Throws Error when `command` is not sound or is for another groom than `groom_id` (0 stands for it).
void checkCommand(const Command& command, uint32_t groom_id);
/// Throws Error on 0, which stands for a subscriber's own groom.
void checkGroomId(uint32_t groom_id, const char* where);

}  // namespace strandcast
