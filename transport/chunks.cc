#include "transport/chunks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "transport/all_finite.h"

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

constexpr size_t kGroomBytesPerStrand = 4 + 8 + 2;
constexpr size_t kGroomBytesPerVertex = 12 + 1 + 4;
constexpr size_t kGuideBytesPerVertex = 12;
/// Most bytes in chunk 0 of a frame: ids and poses, ids and bends.
constexpr size_t kColliderBytes = kMaxPlacedColliders * (4 + 4 * 7 + 4 + 4 * kBendNumbers);
constexpr size_t kPositionsPerBodyChunk = kMaxChunkBytes / (12 + 12 + 4);
constexpr size_t kTrianglesPerBodyChunk = kMaxChunkBytes / 12;

size_t chunksFor(size_t count, size_t per_chunk) { return (count + per_chunk - 1) / per_chunk; }

}  // namespace

void checkAnnouncement(const GroomDescription& groom, const BodyDescription& body, const std::string& where) {
  checkGroom(groom, where);
  checkBody(body, where);
  const size_t body_chunks = chunksFor(body.mesh.positions.size(), kPositionsPerBodyChunk) +
                             chunksFor(body.mesh.triangles.size(), kTrianglesPerBodyChunk);
  const size_t groom_chunks =
      divideStrands(groom.guides.offsets, kGroomBytesPerStrand, kGroomBytesPerVertex).size();
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
  const std::vector<StrandRun> runs =
      divideStrands(guides.offsets, kGroomBytesPerStrand, kGroomBytesPerVertex);
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
    chunk.hair_radius = groom.hair_radius;
    chunk.arrays = (guides.pinned.empty() ? 0u : GroomChunk::kPinned) |
                   (guides.radii.empty() ? 0u : GroomChunk::kRadii) |
                   (guides.uvs.empty() ? 0u : GroomChunk::kUvs) |
                   (guides.parts.empty() ? 0u : GroomChunk::kParts);
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
         command.values.size() <= 64 &&
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

}  // namespace strandcast
