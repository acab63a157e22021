#include "chunk_fuzz.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>

#include "limb.h"
#include "transport/assembler.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), left_(size) {}
  bool empty() const { return left_ == 0; }
  uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  /// Mostly small, so that chunks fit each other; 255 introduces an arbitrary number.
  uint32_t number() {
    const uint8_t small = byte();
    return small < 255 ? small : byte() | byte() << 8 | byte() << 16 | static_cast<uint32_t>(byte()) << 24;
  }
  float real() {
    const uint32_t bits = number();
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  template <class T, class Next>
  void fill(std::vector<T>& values, size_t expected, Next next) {
    // Usually the expected length; 255 selects another one.
    const uint8_t choice = byte();
    values.resize(std::min<size_t>(choice < 255 ? expected : byte(), 1024));
    for (T& value : values) value = static_cast<T>(next());
  }

 private:
  const uint8_t* data_;
  size_t left_;
};

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Chunk>
void readHeader(Bytes& bytes, Chunk& chunk) {
  chunk.session = 1 + bytes.byte() % 2;
  chunk.groom_id = 1;
  chunk.chunk_index = bytes.number();
  chunk.chunk_count = bytes.number();
  chunk.revision = bytes.byte() % 2;
}

GroomChunk readGroomChunk(Bytes& bytes) {
  GroomChunk chunk;
  readHeader(bytes, chunk);
  chunk.total_strands = bytes.number();
  chunk.total_vertices = bytes.number();
  chunk.first_strand = bytes.number();
  chunk.first_vertex = bytes.number();
  chunk.arrays = bytes.byte() % 17;
  bytes.fill(chunk.vertex_counts, bytes.byte() % 8, [&] { return bytes.number(); });
  size_t vertices = 0;
  for (const uint32_t count : chunk.vertex_counts) vertices += count % 4096;
  const size_t strands = chunk.vertex_counts.size();
  const auto when = [&](uint32_t bit, size_t count) { return (chunk.arrays & bit) != 0 ? count : 0; };
  bytes.fill(chunk.positions, 3 * vertices, [&] { return bytes.real(); });
  bytes.fill(chunk.pinned, when(GroomChunk::kPinned, vertices), [&] { return bytes.byte(); });
  bytes.fill(chunk.radii, when(GroomChunk::kRadii, vertices), [&] { return bytes.real(); });
  bytes.fill(chunk.uvs, when(GroomChunk::kUvs, 2 * strands), [&] { return bytes.real(); });
  bytes.fill(chunk.parts, when(GroomChunk::kParts, strands), [&] { return bytes.byte(); });
  return chunk;
}

HairChunk readHairChunk(Bytes& bytes) {
  HairChunk chunk;
  readHeader(bytes, chunk);
  chunk.total_hairs = bytes.number();
  chunk.total_vertices = bytes.number();
  chunk.first_hair = bytes.number();
  chunk.first_vertex = bytes.number();
  chunk.hair_count = bytes.number();
  chunk.vertex_count = bytes.number();
  chunk.arrays = bytes.byte() % 33;
  chunk.encoding = bytes.byte() / 255;
  const auto step = [&] { return bytes.byte() == 255 ? bytes.real() : 1e-5f; };
  chunk.step = step();
  chunk.radius_step = step();
  if (bytes.byte() == 255) chunk.uv_box[0] = bytes.real();
  bytes.fill(chunk.payload, bytes.byte(), [&] { return bytes.byte(); });
  return chunk;
}

BodyChunk readBodyChunk(Bytes& bytes) {
  BodyChunk chunk;
  readHeader(bytes, chunk);
  chunk.total_positions = bytes.number();
  chunk.total_triangles = bytes.number();
  chunk.first_position = bytes.number();
  chunk.first_triangle = bytes.number();
  chunk.arrays = bytes.byte() % 5;
  const size_t positions = bytes.byte() % 8, triangles = bytes.byte() % 8;
  const auto when = [&](uint32_t bit, size_t count) { return (chunk.arrays & bit) != 0 ? count : 0; };
  bytes.fill(chunk.positions, 3 * positions, [&] { return bytes.real(); });
  bytes.fill(chunk.normals, when(BodyChunk::kNormals, 3 * positions), [&] { return bytes.real(); });
  bytes.fill(chunk.head_weights, when(BodyChunk::kHeadWeights, positions), [&] { return bytes.real(); });
  bytes.fill(chunk.triangles, 3 * triangles, [&] { return bytes.number(); });
  return chunk;
}

GuideChunk readGuideChunk(Bytes& bytes) {
  GuideChunk chunk;
  readHeader(bytes, chunk);
  chunk.frame = bytes.number();
  chunk.publish_time = bytes.byte() % 2;
  chunk.first_strand = bytes.number();
  chunk.strand_count = bytes.number();
  chunk.first_vertex = bytes.number();
  chunk.vertex_count = bytes.number();
  chunk.encoding = static_cast<Encoding>(bytes.byte() / 255);
  if (bytes.byte() == 255) chunk.head_rotation[0] = bytes.real();
  // Four of these are a unit quaternion
  const auto number = [&] { return bytes.byte() > 250 ? bytes.real() : 0.5f; };
  const size_t placed = bytes.byte() / 64;
  bytes.fill(chunk.colliders, placed, [&] { return bytes.number(); });
  bytes.fill(chunk.collider_poses, 7 * placed, number);
  bytes.fill(chunk.bent_colliders, bytes.byte() / 64, [&] { return bytes.number(); });
  bytes.fill(chunk.collider_bends, kBendNumbers * chunk.bent_colliders.size(), number);
  bytes.fill(chunk.payload, std::min<uint32_t>(chunk.vertex_count, 80) * 12,
             [&] { return bytes.byte() / 16; });
  return chunk;
}

/// A single complete chunk, so that its shapes are checked; their words come from the input.
ColliderChunk readColliderChunk(Bytes& bytes) {
  ColliderChunk chunk;
  readHeader(bytes, chunk);
  const size_t shapes = bytes.byte() % 4;
  chunk.total_shapes = static_cast<uint32_t>(shapes) + bytes.byte() / 250;
  chunk.first_shape = bytes.byte() / 250;
  bytes.fill(chunk.colliders, shapes, [&] { return bytes.number(); });
  bytes.fill(chunk.kinds, shapes, [&] { return bytes.byte() % 9; });
  bytes.fill(chunk.follows_head, shapes, [&] { return bytes.byte() % 2; });
  bytes.fill(chunk.word_counts, shapes, [&] { return bytes.number(); });
  bytes.fill(chunk.numbers, 16 * shapes, [&] { return bytes.byte() == 255 ? bytes.real() : 0.5f; });
  size_t words = 0;
  for (const uint32_t count : chunk.word_counts) words += count % 1024;
  chunk.total_words = static_cast<uint32_t>(words);
  bytes.fill(chunk.words, words, [&] { return bytes.number(); });
  return chunk;
}

void checkColliderSet(const ColliderSet& set) {
  for (const Collider& collider : set.colliders) {
    for (const ContactPrimitive& shape : collider.shapes) {
      checkPrimitive(shape, "fuzz");
      ShapeData data;
      const uint32_t first = data.add(shape);
      const MovingPrimitive placed = moved(shape, Pose{}, Pose{}, 1, first);
      require(!std::isnan(signedDistance(placed, Vec3(0.1f, 0.2f, 0.3f), data.words)));
    }
  }
}

void checkGroom(const GroomDescription& groom) {
  const StrandSet& guides = groom.guides;
  require(guides.offsets.front() == 0 && guides.offsets.back() == guides.vertices() && guides.strands() > 0);
  require(std::is_sorted(guides.offsets.begin(), guides.offsets.end()));
  for (const Vec3& position : guides.positions) require(position.allFinite());
  require(guides.pinned.empty() || guides.pinned.size() == guides.vertices());
  require(guides.radii.empty() || guides.radii.size() == guides.vertices());
  require(guides.uvs.empty() || guides.uvs.size() == guides.strands());
  require(guides.parts.empty() || guides.parts.size() == guides.strands());
}

void checkBody(const BodyDescription& body) {
  const size_t positions = body.mesh.positions.size();
  require(body.mesh.normals.empty() || body.mesh.normals.size() == positions);
  require(body.head_weights.empty() || body.head_weights.size() == positions);
  for (const auto& triangle : body.mesh.triangles) {
    for (const uint32_t index : triangle) require(index < positions);
  }
}

}  // namespace

size_t fuzzChunks(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  size_t completed = 0;
  GroomAssembler grooms(1);
  BodyAssembler bodies(1);
  ColliderAssembler colliders(1);
  HairAssembler hairs(1);
  std::shared_ptr<const GroomDescription> newest_groom;
  const auto take = [&](const std::shared_ptr<const HairDescription>& complete) {
    if (!complete) return;
    checkHairs(*complete, newest_groom->guides, "fuzz");
    require(complete->session == newest_groom->session && complete->revision == newest_groom->revision);
    ++completed;
  };
  GuideAssembler frames, concealing(true);
  ColliderSet parts = limbs({limb(0), limb(1)});  // frames may have poses of these
  parts.session = 1;
  concealing.setColliders(std::make_shared<ColliderSet>(std::move(parts)));
  size_t vertices = 0;
  uint64_t newest = 0;
  while (!bytes.empty()) {
    switch (bytes.byte() % 5) {
      case 0:
        if (const auto groom = grooms.add(readGroomChunk(bytes))) {
          checkGroom(*groom);
          frames.setGroom(groom);
          concealing.setGroom(groom);
          vertices = groom->guides.vertices();
          newest = 0;
          ++completed;
          newest_groom = groom;
          take(hairs.setGroom(groom));
        }
        break;
      case 1:
        if (const auto body = bodies.add(readBodyChunk(bytes))) {
          checkBody(*body);
          ++completed;
        }
        break;
      case 2:
        if (const auto set = colliders.add(readColliderChunk(bytes))) {
          checkColliderSet(*set);
          concealing.setColliders(set);
          ++completed;
        }
        break;
      case 3:
        take(hairs.add(readHairChunk(bytes)));
        break;
      default: {
        const GuideChunk chunk = readGuideChunk(bytes);
        for (const auto& frame : {concealing.add(chunk), concealing.concealOverdue()})
          if (frame) require(isSound(*frame, vertices));
        if (const auto frame = frames.add(chunk)) {
          require(isSound(*frame, vertices));
          require(frame->frame > newest);
          newest = frame->frame;
          ++completed;
        }
      }
    }
  }
  return completed;
}

std::vector<FuzzSeeds> chunkSeeds() {
  constexpr int kTried = 20000;
  std::vector<FuzzSeeds> seeds = {{"chunks", {}}};
  std::mt19937 random(1);
  for (int i = 0; i < kTried; ++i) {
    std::vector<uint8_t> bytes(random() % 512);
    for (uint8_t& byte : bytes)
      byte =
          static_cast<uint8_t>(random() % 40 == 0 ? random() : random() % (2 + static_cast<uint32_t>(i) % 3));
    if (fuzzChunks(bytes.data(), bytes.size()) > 0) seeds[0].inputs.push_back(std::move(bytes));
  }
  return seeds;
}

}  // namespace strandcast
