#include "transport/assembler.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "transport/chunks.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

constexpr size_t kMaxPendingDescriptions = 2;
constexpr size_t kMaxPendingFrames = 4;
/// Once so many frames have begun since the last chunk of a frame, no more of its chunks are expected.
constexpr uint64_t kPendingTimeout = 8;

/// Whether an optional array has `count` entries if present, and none if absent.
template <class T>
bool hasLength(const std::vector<T>& values, bool present, uint64_t count) {
  return values.size() == (present ? count : 0);
}

/// Whether [first, first + count) lies within a total. 64 bits, so that sums of received numbers cannot wrap.
bool isWithin(uint64_t first, uint64_t count, uint64_t total) {
  return first <= total && count <= total - first;
}

template <class Chunk>
bool hasSoundHeader(const Chunk& chunk) {
  return chunk.session != 0 && chunk.chunk_count >= 1 && chunk.chunk_count <= kMaxChunks &&
         chunk.chunk_index < chunk.chunk_count && chunk.name.size() <= kMaxTextBytes;
}

template <class Vector>
void appendVectors(std::vector<Vector>& to, const std::vector<float>& from) {
  constexpr size_t kComponents = sizeof(Vector) / sizeof(float);
  const size_t old_size = to.size();
  to.resize(old_size + from.size() / kComponents);
  if (!from.empty())
    std::memcpy(static_cast<void*>(to.data() + old_size), from.data(), from.size() * sizeof(float));
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// ---- groom

bool isSoundAlone(const GroomChunk& chunk) {
  const uint64_t strands = chunk.vertex_counts.size();
  uint64_t vertices = 0;
  for (const uint32_t count : chunk.vertex_counts) {
    if (count < 1 || count > kMaxWireVertices) return false;
    vertices += count;
  }
  const auto has = [&](uint32_t bit) { return (chunk.arrays & bit) != 0; };
  return hasSoundHeader(chunk) && chunk.arrays < 64 && chunk.growth >= 1 && chunk.growth < 8 &&
         strands >= 1 &&
         bytesOf(chunk.vertex_counts, chunk.positions, chunk.pinned, chunk.radii, chunk.uvs, chunk.parts,
                 chunk.seeded, chunk.ids) <= kMaxChunkBytes &&
         isWithin(chunk.first_strand, strands, chunk.total_strands) &&
         isWithin(chunk.first_vertex, vertices, chunk.total_vertices) &&
         chunk.positions.size() == 3 * vertices &&
         hasLength(chunk.pinned, has(GroomChunk::kPinned), vertices) &&
         hasLength(chunk.radii, has(GroomChunk::kRadii), vertices) &&
         hasLength(chunk.uvs, has(GroomChunk::kUvs), 2 * strands) &&
         hasLength(chunk.parts, has(GroomChunk::kParts), strands) &&
         hasLength(chunk.seeded, has(GroomChunk::kSeeded), strands) &&
         hasLength(chunk.ids, has(GroomChunk::kIds), strands) && isHairRadius(chunk.hair_radius) &&
         allFinite(chunk.positions) && allFinite(chunk.radii) &&
         std::all_of(chunk.radii.begin(), chunk.radii.end(), [](float r) { return r >= 0; }) &&
         allFinite(chunk.uvs);
}

bool agree(const GroomChunk& a, const GroomChunk& b) {
  return a.chunk_count == b.chunk_count && a.total_strands == b.total_strands &&
         a.total_vertices == b.total_vertices && a.growth == b.growth && a.hair_radius == b.hair_radius &&
         a.arrays == b.arrays && a.name == b.name;
}

/// Null unless the chunks are consecutive and make up the totals.
std::shared_ptr<const GroomDescription> build(const std::map<uint32_t, GroomChunk>& chunks) {
  auto groom = std::make_shared<GroomDescription>();
  StrandSet& guides = groom->guides;
  for (const auto& [index, chunk] : chunks) {
    if (chunk.first_strand != guides.strands() || chunk.first_vertex != guides.vertices()) return nullptr;
    for (const uint32_t count : chunk.vertex_counts) guides.offsets.push_back(guides.offsets.back() + count);
    appendVectors(guides.positions, chunk.positions);
    append(guides.pinned, chunk.pinned);
    append(guides.radii, chunk.radii);
    appendVectors(guides.uvs, chunk.uvs);
    append(guides.parts, chunk.parts);
    append(groom->seeded, chunk.seeded);
    append(groom->ids, chunk.ids);
  }
  const GroomChunk& first = chunks.begin()->second;
  if (guides.strands() != first.total_strands || guides.vertices() != first.total_vertices) return nullptr;
  groom->groom_id = first.groom_id;
  groom->session = first.session;
  groom->revision = first.revision;
  groom->name = first.name;
  groom->growth = first.growth;
  groom->hair_radius = first.hair_radius;
  return groom;
}

// ---- hairs

bool isSoundAlone(const HairChunk& chunk) {
  return chunk.session != 0 && chunk.chunk_count >= 1 && chunk.chunk_count <= kMaxChunks &&
         chunk.chunk_index < chunk.chunk_count && isSoundHead(chunk) && chunk.total_hairs <= kMaxHairs &&
         isWithin(chunk.first_hair, chunk.hair_count, chunk.total_hairs) &&
         isWithin(chunk.first_vertex, chunk.vertex_count, chunk.total_vertices) &&
         chunk.payload.size() <= kMaxChunkBytes;
}

bool agree(const HairChunk& a, const HairChunk& b) {
  return a.chunk_count == b.chunk_count && a.total_hairs == b.total_hairs &&
         a.total_vertices == b.total_vertices && a.arrays == b.arrays && a.encoding == b.encoding &&
         a.step == b.step && a.radius_step == b.radius_step && a.uv_box == b.uv_box;
}

/// Null unless the chunks are consecutive and make up the totals. Moves their payloads.
std::shared_ptr<const HairChunks> build(std::map<uint32_t, HairChunk>&& chunks) {
  auto all = std::make_shared<HairChunks>();
  uint64_t hairs = 0, vertices = 0;
  for (auto& [index, chunk] : chunks) {
    if (chunk.first_hair != hairs || chunk.first_vertex != vertices) return nullptr;
    hairs += chunk.hair_count;
    vertices += chunk.vertex_count;
    all->push_back(std::move(chunk));
  }
  return hairs == all->front().total_hairs && vertices == all->front().total_vertices ? all : nullptr;
}

// ---- body

bool isSoundAlone(const BodyChunk& chunk) {
  const uint64_t positions = chunk.positions.size() / 3, triangles = chunk.triangles.size() / 3;
  const auto is_weight = [](float w) { return w >= 0 && w <= 1; };  // false for NaN
  return hasSoundHeader(chunk) && chunk.arrays < 4 &&
         bytesOf(chunk.positions, chunk.normals, chunk.head_weights, chunk.triangles) <= kMaxChunkBytes &&
         chunk.positions.size() % 3 == 0 && chunk.triangles.size() % 3 == 0 &&
         isWithin(chunk.first_position, positions, chunk.total_positions) &&
         isWithin(chunk.first_triangle, triangles, chunk.total_triangles) &&
         hasLength(chunk.normals, (chunk.arrays & BodyChunk::kNormals) != 0, 3 * positions) &&
         hasLength(chunk.head_weights, (chunk.arrays & BodyChunk::kHeadWeights) != 0, positions) &&
         allFinite(chunk.positions) && allFinite(chunk.normals) &&
         std::all_of(chunk.head_weights.begin(), chunk.head_weights.end(), is_weight) &&
         std::all_of(chunk.triangles.begin(), chunk.triangles.end(),
                     [&](uint32_t index) { return index < chunk.total_positions; });
}

bool agree(const BodyChunk& a, const BodyChunk& b) {
  return a.chunk_count == b.chunk_count && a.total_positions == b.total_positions &&
         a.total_triangles == b.total_triangles && a.arrays == b.arrays && a.name == b.name;
}

std::shared_ptr<const BodyDescription> build(const std::map<uint32_t, BodyChunk>& chunks) {
  auto body = std::make_shared<BodyDescription>();
  TriangleMesh& mesh = body->mesh;
  for (const auto& [index, chunk] : chunks) {
    if (chunk.first_position != mesh.positions.size() || chunk.first_triangle != mesh.triangles.size())
      return nullptr;
    appendVectors(mesh.positions, chunk.positions);
    appendVectors(mesh.normals, chunk.normals);
    append(body->head_weights, chunk.head_weights);
    for (size_t i = 0; i < chunk.triangles.size(); i += 3) {
      mesh.triangles.push_back({chunk.triangles[i], chunk.triangles[i + 1], chunk.triangles[i + 2]});
    }
  }
  const BodyChunk& first = chunks.begin()->second;
  if (mesh.positions.size() != first.total_positions || mesh.triangles.size() != first.total_triangles)
    return nullptr;
  body->groom_id = first.groom_id;
  body->session = first.session;
  body->revision = first.revision;
  mesh.name = first.name;
  return body;
}

// ---- guides

bool agree(const GuideChunk& a, const GuideChunk& b) {
  return a.chunk_count == b.chunk_count && a.writers == b.writers && a.publish_time == b.publish_time &&
         a.pose_source == b.pose_source && a.pose_time == b.pose_time &&
         a.simulation_time == b.simulation_time && a.continuity == b.continuity &&
         a.head_position == b.head_position && a.head_rotation == b.head_rotation;
}

/// Finite position and unit quaternion.
bool isSoundPose(std::span<const float, 3> position, std::span<const float, 4> rotation) {
  float squared = 0;
  for (const float component : rotation) squared += component * component;
  return std::all_of(position.begin(), position.end(), [](float v) { return std::isfinite(v); }) &&
         std::abs(squared - 1) < 1e-3f;  // false for NaN
}

/// Whether the ids are in the order of the chunk's colliders, at most once each.
bool hasSoundBends(const GuideChunk& chunk) {
  auto next = chunk.colliders.begin();
  for (const uint32_t id : chunk.bent_colliders) {
    next = std::find(next, chunk.colliders.end(), id);
    if (next == chunk.colliders.end()) return false;
    ++next;
  }
  return chunk.collider_bends.size() == kBendNumbers * chunk.bent_colliders.size() &&
         std::all_of(chunk.collider_bends.begin(), chunk.collider_bends.end(),
                     [](float v) { return std::abs(v) <= kMaxBendNumber; });
}

bool hasSoundPoses(const GuideChunk& chunk) {
  const size_t placed = chunk.colliders.size();
  if (placed > (chunk.chunk_index == 0 ? kMaxPlacedColliders : 0) ||
      chunk.collider_poses.size() != 7 * placed)
    return false;
  for (size_t i = 0; i < placed; ++i) {
    const std::span<const float> pose(chunk.collider_poses.data() + 7 * i, 7);
    if (!isSoundPose(pose.first<3>(), pose.last<4>())) return false;
  }
  return hasSoundBends(chunk) && isSoundPose(chunk.head_position, chunk.head_rotation);
}

void placeColliders(const GuideChunk& chunk, GuideFrame& frame) {
  frame.colliders.resize(chunk.colliders.size());
  size_t bent = 0;
  for (size_t i = 0; i < chunk.colliders.size(); ++i) {
    const float* const pose = chunk.collider_poses.data() + 7 * i;
    PlacedCollider& placed = frame.colliders[i];
    placed.id = chunk.colliders[i];
    placed.pose.position = Vec3(pose);
    placed.pose.rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(pose + 3);
    placed.bend = {};
    if (bent == chunk.bent_colliders.size() || chunk.bent_colliders[bent] != placed.id) continue;
    const float* number = chunk.collider_bends.data() + kBendNumbers * bent++;
    bendNumbers(placed.bend, [&](float& into) { into = *number++; });
  }
}

}  // namespace

// ---- descriptions

template <class Chunk, class Description>
typename DescriptionAssembler<Chunk, Description>::Pending*
DescriptionAssembler<Chunk, Description>::pendingFor(const Chunk& chunk) {
  const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    const Chunk& first = pending.chunks.begin()->second;
    return first.session == chunk.session && first.revision == chunk.revision;
  });
  if (found != pending_.end()) {
    if (!agree(found->chunks.begin()->second, chunk)) return nullptr;
    pending_.splice(pending_.begin(), pending_, found);
    return &pending_.front();
  }
  if (pending_.size() == kMaxPendingDescriptions) pending_.pop_back();
  pending_.emplace_front();
  return &pending_.front();
}

template <class Chunk, class Description>
std::shared_ptr<const Description> DescriptionAssembler<Chunk, Description>::add(Chunk&& chunk) {
  Pending* pending = chunk.groom_id == groom_id_ && isSoundAlone(chunk) ? pendingFor(chunk) : nullptr;
  if (!pending) {
    ++chunks_rejected_;
    return nullptr;
  }
  const uint32_t chunk_count = chunk.chunk_count, index = chunk.chunk_index;
  pending->chunks.emplace(index, std::move(chunk));  // a repeated chunk changes nothing
  if (pending->chunks.size() < chunk_count) return nullptr;
  std::shared_ptr<const Description> description = build(std::move(pending->chunks));
  if (!description) chunks_rejected_ += chunk_count;
  pending_.pop_front();
  return description;
}

template class DescriptionAssembler<GroomChunk, GroomDescription>;
template class DescriptionAssembler<BodyChunk, BodyDescription>;
template class DescriptionAssembler<ColliderChunk, ColliderSet>;
template class DescriptionAssembler<HairChunk, HairChunks>;

std::shared_ptr<const HairDescription> HairAssembler::add(HairChunk&& chunk) {
  auto complete = chunks_.add(std::move(chunk));
  if (!complete) return nullptr;
  waiting_ = std::move(complete);
  return decode();
}

std::shared_ptr<const HairDescription> HairAssembler::setGroom(
    std::shared_ptr<const GroomDescription> groom) {
  groom_ = std::move(groom);
  return decode();
}

std::shared_ptr<const HairDescription> HairAssembler::decode() {
  if (!groom_ || !waiting_ || waiting_->front().session != groom_->session ||
      waiting_->front().revision != groom_->revision)
    return nullptr;
  const auto chunks = std::exchange(waiting_, nullptr);
  auto hairs = std::make_shared<HairDescription>();
  hairs->groom_id = groom_->groom_id;
  hairs->session = groom_->session;
  hairs->revision = groom_->revision;
  for (const HairChunk& chunk : *chunks) {
    if (decodeHairs(chunk, groom_->guides, *hairs)) continue;
    chunks_rejected_ += chunks->size();
    return nullptr;
  }
  return hairs;
}

// ---- frames

void GuideAssembler::setGroom(std::shared_ptr<const GroomDescription> groom) {
  groom_ = std::move(groom);
  decoder_.setGroom(groom_->guides);
  if (conceals_) concealment_.setGroom(groom_->guides);
  if (colliders_) setColliders(std::move(colliders_));
  restart();
}

void GuideAssembler::setColliders(std::shared_ptr<const ColliderSet> colliders) {
  if (!conceals_) return;
  colliders_ = std::move(colliders);
  if (groom_ && groom_->session == colliders_->session) concealment_.setColliders(*colliders_);
}

void GuideAssembler::restart() {
  for (Pending& pending : pending_) pool_.release(std::move(pending.frame));
  pending_.clear();
  sequence_.restart();
}

bool GuideAssembler::fits(const GuideChunk& chunk) const {
  const StrandSet& guides = groom_->guides;
  if (chunk.groom_id != groom_->groom_id || chunk.session != groom_->session ||
      chunk.revision != groom_->revision || chunk.frame == 0 || chunk.chunk_index >= chunk.chunk_count ||
      chunk.chunk_count > kMaxChunks || chunk.chunk_count > guides.strands() || chunk.strand_count < 1 ||
      chunk.writer >= chunk.writers || chunk.writers > kMaxWriters ||
      !isWithin(chunk.first_strand, chunk.strand_count, guides.strands())) {
    return false;
  }
  const uint32_t first_vertex = guides.offsets[chunk.first_strand];
  const uint32_t vertices = guides.offsets[chunk.first_strand + chunk.strand_count] - first_vertex;
  return chunk.first_vertex == first_vertex && chunk.vertex_count == vertices &&
         chunk.payload.size() <= kMaxChunkBytes && vertices * sizeof(Vec3) <= kMaxChunkBytes &&
         std::isfinite(chunk.simulation_time) && hasSoundPoses(chunk);
}

GuideAssembler::Pending* GuideAssembler::pendingFor(const GuideChunk& chunk) {
  const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    return pending.header.frame == chunk.frame;
  });
  if (found != pending_.end()) {
    if (!agree(found->header, chunk)) return nullptr;
    pending_.splice(pending_.begin(), pending_, found);
    return &pending_.front();
  }
  ++begun_;
  // Drop the least recently fed, not the lowest number: a damaged number must not keep its slot, nor make all
  // frames before it overdue.
  while (!pending_.empty() &&
         (pending_.size() == kMaxPendingFrames || begun_ - pending_.back().fed > kPendingTimeout))
    drop(std::prev(pending_.end()));
  Pending& pending = pending_.emplace_front();
  pending.header.frame = chunk.frame;
  pending.header.chunk_count = chunk.chunk_count;
  pending.header.writers = chunk.writers;
  pending.header.publish_time = chunk.publish_time;
  pending.header.pose_source = chunk.pose_source;
  pending.header.pose_time = chunk.pose_time;
  pending.header.continuity = chunk.continuity;
  pending.header.simulation_time = chunk.simulation_time;
  pending.header.head_position = chunk.head_position;
  pending.header.head_rotation = chunk.head_rotation;
  pending.frame = pool_.acquire();
  pending.frame->positions.resize(groom_->guides.vertices());
  pending.runs.resize(chunk.chunk_count);
  return &pending;
}

std::shared_ptr<const GuideFrame> GuideAssembler::add(const GuideChunk& chunk) {
  if (!groom_) return nullptr;
  if (!fits(chunk)) {
    ++statistics_.chunks_rejected;
    return nullptr;
  }
  switch (sequence_.classify(chunk.frame)) {
    case FrameSequence::Order::kNext:
      break;
    case FrameSequence::Order::kLate:
      return nullptr;  // counted as lost when the newer frame was completed
    case FrameSequence::Order::kFar:
      ++statistics_.chunks_rejected;
      return nullptr;
    case FrameSequence::Order::kRestart:
      restart();
  }
  // Before any state changes: a damaged payload has no effect.
  decoded_.resize(chunk.vertex_count);
  const DecodeResult decoded = decoder_.decode(chunk, decoded_);
  Pending* pending = decoded == DecodeResult::kDone ? pendingFor(chunk) : nullptr;
  if (!pending) {
    ++(decoded == DecodeResult::kNoKey ? statistics_.chunks_without_key : statistics_.chunks_rejected);
    return nullptr;
  }
  StrandRun& run = pending->runs[chunk.chunk_index];
  if (run.strand_count != 0) return nullptr;  // received twice
  run = {chunk.first_strand, chunk.strand_count, chunk.first_vertex, chunk.vertex_count};
  std::copy(decoded_.begin(), decoded_.end(), pending->frame->positions.begin() + run.first_vertex);
  if (chunk.chunk_index == 0) placeColliders(chunk, *pending->frame);
  pending->fed = begun_;
  pending->bytes += chunk.payload.size();
  return ++pending->received == chunk.chunk_count ? complete(pending_.begin()) : nullptr;
}

void GuideAssembler::drop(std::list<Pending>::iterator pending) {
  pool_.release(std::move(pending->frame));
  pending_.erase(pending);
}

std::shared_ptr<const GuideFrame> GuideAssembler::complete(std::list<Pending>::iterator pending) {
  uint64_t next_strand = 0;
  bool is_whole = true;
  for (const StrandRun& run : pending->runs) {
    is_whole = is_whole && run.first_strand == next_strand;
    next_strand += run.strand_count;
  }
  if (!is_whole || next_strand != groom_->guides.strands()) {
    statistics_.chunks_rejected += pending->header.chunk_count;
    drop(pending);
    return nullptr;
  }
  return release(pending);
}

std::shared_ptr<const GuideFrame> GuideAssembler::concealOverdue() {
  auto oldest = pending_.end();
  uint64_t later = 0;  // newest frame of which a quarter is here
  for (auto here = pending_.begin(); here != pending_.end(); ++here) {
    if (uint64_t{here->received} * 4 >= here->header.chunk_count) later = std::max(later, here->header.frame);
    if (oldest == pending_.end() || here->header.frame < oldest->header.frame) oldest = here;
  }
  return oldest != pending_.end() && oldest->header.frame < later ? release(oldest) : nullptr;
}

/// Null when lost strands cannot be concealed.
std::shared_ptr<const GuideFrame> GuideAssembler::release(std::list<Pending>::iterator pending) {
  const GuideChunk& header = pending->header;
  GuideFrame& frame = *pending->frame;
  frame.groom_id = groom_->groom_id;
  frame.session = groom_->session;
  frame.revision = groom_->revision;
  frame.frame = header.frame;
  frame.simulation_time = header.simulation_time;
  frame.publish_time = header.publish_time;
  frame.pose_source = header.pose_source;
  frame.pose_time = header.pose_time;
  frame.continuity = header.continuity;
  frame.arrival_time = steadyTime();
  frame.head.position = Vec3(header.head_position.data());
  frame.head.rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(header.head_rotation.data());
  frame.strands_concealed = 0;
  if (conceals_) {
    concealment_.record(frame, pending->runs);
    if (pending->received < header.chunk_count && !concealment_.conceal(frame)) {
      drop(pending);
      return nullptr;
    }
  }
  if (sequence_.newest() != 0) statistics_.frames_lost += frame.frame - sequence_.newest() - 1;
  sequence_.take(frame.frame);
  ++statistics_.frames_received;
  statistics_.payload_bytes += pending->bytes;
  statistics_.strands_concealed += frame.strands_concealed;
  statistics_.frames_concealed += frame.strands_concealed > 0 ? 1 : 0;
  const uint64_t frame_number = frame.frame;
  FramePool::Buffer buffer = std::move(pending->frame);
  pending_.erase(pending);
  for (auto older = pending_.begin(); older != pending_.end();) {
    const auto here = older++;
    if (here->header.frame <= frame_number) drop(here);
  }
  return pool_.share(std::move(buffer));
}

}  // namespace strandcast
