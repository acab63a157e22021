#include "gpu_compute/gpu_strands.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/backend.h"
#include "core/broad_phase.h"
#include "core/error.h"
#include "gl/buffer.h"
#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

// Initial capacity of the upload ring for steps with bodies; it grows when exceeded.
constexpr UploadRing::Counts kFirstCounts = {512, 4096};

using Vec4 = std::array<float, 4>;

Vec4 vec4(const Vec3& v, float w = 0) { return {v.x(), v.y(), v.z(), w}; }

template <class T>
gl::Buffer storage(size_t count) {
  return gl::Buffer(count * sizeof(T), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

std::vector<Vec4> packRestLocal(const StrandModel& model) {
  std::vector<Vec4> packed(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      packed[v] = model.isBonePinned(s, v)
                      ? vec4(model.restPosition(s, v), -1 - static_cast<float>(model.pin_bones[v]))
                      : vec4(model.rest_local[v], model.isPinned(s, v) ? 0.0f : 1.0f);
  return packed;
}

/// In the layout of Offsets in shaders/step_input.glsl.
std::vector<uint32_t> packOffsets(const StrandModel& model) {
  std::vector<uint32_t> packed = model.offsets;
  const StrandOrder order = strandOrder(model);
  packed.insert(packed.end(), order.neighbourhood_of.begin(), order.neighbourhood_of.end());
  for (size_t s = 0; s < model.strands(); ++s) packed.push_back(model.rootBone(s));
  return packed;
}

/// Entry of Grooming in shaders/step_input.glsl with all factors 1 and no tether.
const Vec4 kNotGroomed = {1, 1, kNoTether, 0};

std::vector<Vec4> packGrooming(const StrandModel& model) {
  std::vector<Vec4> packed(model.vertices());
  if (!model.friction_along.empty()) packed.resize(2 * model.vertices());
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      packed[v] = {model.air_drag_scale[v], model.goal_scale[v], model.tether[v], 0};
    packed[model.offsets[s]] = {model.friction_scale[s], model.damping_scale[s], 0, 0};
    if (model.friction_along.empty()) continue;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      packed[model.vertices() + v] = {model.frictionFactor(s, v), model.dampingFactor(s, v), 0, 0};
  }
  return packed;
}

// Calls body(edge, its outer vertex) for every edge. The unused last edge entry of a strand is paired with
// its root, so that an upload and a download round-trip all entries.
template <class Body>
void forEdges(std::span<const uint32_t> offsets, const Body& body) {
  for (size_t s = 0; s + 1 < offsets.size(); ++s) {
    for (uint32_t v = offsets[s]; v + 1 < offsets[s + 1]; ++v) body(v, v + 1);
    body(offsets[s + 1] - 1, offsets[s]);
  }
}

// Throws Error if a buffer of `rows` Vec4 per vertex exceeds the driver's limit.
void checkFits(size_t vertices, size_t rows = 1) {
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  if (vertices * rows * sizeof(Vec4) > static_cast<uint64_t>(limit))
    throw Error(fmt::format("{} vertices are too many for this GPU's buffers", vertices),
                reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                "use fewer strands or --backend simd");
}

bool isField(const MovingPrimitive& body) {
  return body.kind == static_cast<uint32_t>(PrimitiveKind::kField);
}
// Whether the kind has a rotation: SHAPE_KINDS 1.
bool turns(const MovingPrimitive& body) {
  return body.kind >= static_cast<uint32_t>(PrimitiveKind::kEllipsoid);
}

}  // namespace

GpuStrands::GpuStrands(const StrandModel& model, ProgramCache& programs, size_t small_model_vertices,
                       bool compiles_slowly)
    : programs_(programs),
      model_(model),
      small_model_vertices_(small_model_vertices),
      compiles_slowly_(compiles_slowly),
      vertices_((checkFits(model.vertices()), gl::discardErrors(), model.vertices())),
      positions_(storage<Vec4>(vertices_)),
      velocities_(storage<Vec4>(vertices_)),
      frames_(storage<Vec4>(vertices_)),
      offsets_(std::span<const uint32_t>(packOffsets(model))),
      guides_(storage<Vec3>(vertices_)),
      shapes_(storage<uint32_t>(1)),
      groomed_(!model.damping_scale.empty()),
      uploads_(std::in_place, model, UploadRing::Counts{}),
      readback_(vertices_ * sizeof(Vec3)) {
  checkMemory("the model does not fit the GPU's memory");
}

void GpuStrands::checkMemory(const char* what) const {
  if (gl::ranOutOfMemory())
    throw Error(what, fmt::format("{} vertices", vertices_), "use fewer strands or --backend simd");
}

void GpuStrands::prepare(const Parameters& parameters, bool bodies) {
  if (vertices_ == 0) return;
  const bool rod = parameters.solver == SolverKind::kRod, goal = parameters.goal_rate > 0;
  bool& expected = expected_[(rod ? 1 : 0) + (goal ? 2 : 0) + (bodies ? 4 : 0)];
  if (expected) return;
  gl::discardErrors();
  if (rod && !rod_) rod_.emplace(model_, small_model_vertices_, compiles_slowly_);
  if (rod) rod_->prepare(goal, bodies);
  if (!rod && !gauss_seidel_) gauss_seidel_.emplace(model_, compiles_slowly_);
  if (rest_local_.bytes() == 0 && (!rod || goal || rod_->needsRestShape()))
    rest_local_ = gl::Buffer(std::span<const Vec4>(packRestLocal(model_)));
  if (grooming_.bytes() == 0 && (groomed_ || goal)) {
    if (!model_.friction_along.empty()) checkFits(vertices_, 2);
    grooming_ = gl::Buffer(
        std::span<const Vec4>(groomed_ ? packGrooming(model_) : std::vector<Vec4>(vertices_, kNotGroomed)));
  }
  checkMemory("the model does not fit the GPU's memory");
  if (rod && bodies) allocateContactCache();
  if (bodies) growUploadRing(kFirstCounts);
  expected = true;
}

void GpuStrands::upload(const StrandState& state) {
  std::vector<Vec4> packed(vertices_);
  for (size_t i = 0; i < vertices_; ++i) packed[i] = vec4(state.positions[i]);
  if (!state.tensions.empty())
    forEdges(model_.offsets, [&](uint32_t edge, uint32_t end) { packed[end][3] = state.tensions[edge]; });
  positions_.write(std::span<const Vec4>(packed));
  for (size_t i = 0; i < vertices_; ++i)
    packed[i] =
        vec4(state.velocities[i], model_.rest_distance.empty() ? kFarFromBodies : model_.rest_distance[i]);
  velocities_.write(std::span<const Vec4>(packed));
  for (size_t i = 0; i < vertices_; ++i) {
    const Quat frame = state.frames.empty() ? Quat(Quat::Identity()) : state.frames[i];
    packed[i] = {frame.x(), frame.y(), frame.z(), frame.w()};
  }
  frames_.write(std::span<const Vec4>(packed));
  pressed_ = std::any_of(state.contacts.begin(), state.contacts.end(),
                         [](const Vec3& force) { return force != Vec3::Zero(); });
  if (pressed_ && contacts_.bytes() == 0) contacts_ = storage<Vec4>(vertices_);
  if (contacts_.bytes() > 0) {
    for (size_t i = 0; i < vertices_; ++i) packed[i] = pressed_ ? vec4(state.contacts[i]) : Vec4{};
    contacts_.write(std::span<const Vec4>(packed));
  }
  uploaded_ = state.positions;
  packing_started_ = false;
  if (rod_) rod_->markFramesStored();
  previous_bodies_ = PreviousBodies();
}

void GpuStrands::download(StrandState& state) {
  if (rod_) {
    bind();
    rod_->computeFrames(programs_);
  }
  std::vector<Vec4> packed(vertices_);
  auto read = [&](const gl::Buffer& from) {
    glGetNamedBufferSubData(from.id(), 0, static_cast<GLsizeiptr>(vertices_ * sizeof(Vec4)), packed.data());
  };
  auto unpack = [&](std::vector<Vec3>& to) {
    to.resize(vertices_);
    for (size_t i = 0; i < vertices_; ++i) to[i] = Vec3(packed[i][0], packed[i][1], packed[i][2]);
  };
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  read(positions_);
  unpack(state.positions);
  state.tensions.resize(vertices_);
  forEdges(model_.offsets, [&](uint32_t edge, uint32_t end) { state.tensions[edge] = packed[end][3]; });
  read(velocities_);
  unpack(state.velocities);
  state.contacts.assign(vertices_, Vec3::Zero());
  if (contacts_.bytes() > 0) {
    read(contacts_);
    unpack(state.contacts);
  }
  read(frames_);
  state.frames.resize(vertices_);
  for (size_t i = 0; i < vertices_; ++i)
    state.frames[i] = Quat(packed[i][3], packed[i][0], packed[i][1], packed[i][2]);
}

void GpuStrands::bind() const {
  positions_.bindStorage(0);
  velocities_.bindStorage(1);
  if (rest_local_.bytes() > 0) rest_local_.bindStorage(2);
  offsets_.bindStorage(4);
  guides_.bindStorage(8);
  frames_.bindStorage(9);
  if (contacts_.bytes() > 0) contacts_.bindStorage(3);  // for the rod; gauss_seidel binds rest_edge_ there
  if (grooming_.bytes() > 0) grooming_.bindStorage(13);
  shapes_.bindStorage(14);
}

void GpuStrands::uploadShapes(const ShapeData* shapes) {
  if (shapes == nullptr || shapes->words.empty()) return;
  if (shapes->revision == shapes_revision_) return uploadBends(*shapes);
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  const size_t bytes = shapes->words.size() * sizeof(uint32_t);
  if (bytes > static_cast<uint64_t>(limit))
    throw Error("the shapes of the bodies do not fit this GPU's buffers", fmt::format("{} bytes", bytes),
                "bake their distance fields with larger cells, or use --backend simd");
  gl::discardErrors();
  shapes_ = gl::Buffer(std::span<const uint32_t>(shapes->words));
  if (gl::ranOutOfMemory())
    throw Error("the shapes of the bodies do not fit the GPU's memory", fmt::format("{} bytes", bytes),
                "bake their distance fields with larger cells, or use --backend simd");
  shapes_revision_ = shapes->revision;
}

void GpuStrands::uploadBends(const ShapeData& shapes) const {
  for (const uint32_t at : shapes.bends)
    glNamedBufferSubData(shapes_.id(), static_cast<GLintptr>(at * sizeof(uint32_t)), sizeof(MovingBend),
                         shapes.words.data() + at);
}

void GpuStrands::allocateContactCache() {
  constexpr size_t kSightRows = 5;  // see shaders/contact_cache.glsl
  const size_t bytes = vertices_ * (1 + kSightRows) * sizeof(Vec4);
  if (contacts_.bytes() == bytes) return;
  checkFits(vertices_, 1 + kSightRows);
  gl::Buffer all(bytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
  checkMemory("what hair sees of bodies does not fit the GPU's memory");
  const auto forces = static_cast<GLsizeiptr>(vertices_ * sizeof(Vec4));
  if (contacts_.bytes() > 0)
    glCopyNamedBufferSubData(contacts_.id(), all.id(), 0, 0, forces);
  else
    glClearNamedBufferSubData(all.id(), GL_RGBA32F, 0, forces, GL_RGBA, GL_FLOAT, nullptr);
  contacts_ = std::move(all);
}

void GpuStrands::growUploadRing(const UploadRing::Counts& wanted) {
  if (uploads_->fits(wanted)) return;
  const UploadRing::Counts has = uploads_->capacity();
  glFinish();
  uploads_.emplace(model_,
                   UploadRing::Counts{std::max(has.bodies, wanted.bodies), std::max(has.near, wanted.near)});
}

void GpuStrands::step(const StepInput& input) {
  uploaded_ = std::vector<Vec3>();  // assigning {} would keep its memory
  if (vertices_ == 0) return;
  prepare(*input.parameters, !input.primitives.empty());
  const UploadRing::Counts wanted = UploadRing::countsOf(input);
  if (!uploads_->fits(wanted)) growUploadRing({2 * wanted.bodies, 2 * wanted.near});
  uploadShapes(input.shapes);
  uploads_->write(input);
  const Parameters& p = *input.parameters;
  const bool goal = p.goal_rate > 0;
  const bool accelerated = std::exchange(accelerated_, false) || !input.accelerations.empty();
  if (!input.accelerations.empty()) guides_.write(input.accelerations);
  const bool rod = p.solver == SolverKind::kRod;
  const bool pressing = rod && !input.primitives.empty();
  const bool bends = input.shapes != nullptr && !input.shapes->bends.empty();
  const bool some_turn = std::any_of(input.primitives.begin(), input.primitives.end(), turns);
  const int shape_kinds = bends ? 2 : some_turn ? 1 : 0;
  bind();
  if (pressed_ && !pressing) glClearNamedBufferData(contacts_.id(), GL_RGBA32F, GL_RGBA, GL_FLOAT, nullptr);
  pressed_ = pressing;
  timer_.begin();
  if (rod)
    rod_->step({.bodies = !input.primitives.empty(),
                .shape_kinds = shape_kinds,
                .fields = std::any_of(input.primitives.begin(), input.primitives.end(), isField),
                .goal = goal,
                .accelerated = accelerated,
                .damping = p.damping_time > 0,
                .time2 = static_cast<float>(
                    DragStep(p.air_drag, static_cast<double>(p.time_step) / p.substeps).time2),
                .same_bodies = previous_bodies_.matchesNext(input)},
               p.substeps, programs_);
  else
    gauss_seidel_->step(groomed_ || goal ? (model_.friction_along.empty() ? 1 : 2) : 0, accelerated,
                        shape_kinds > 1, programs_);
  timer_.end();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  guides_read_ = packing_started_ = false;
  head_ = input.boneAtEnd(0);
  glFlush();
}

const gl::Buffer& GpuStrands::shapes(const ShapeData* shapes) {
  uploadShapes(shapes);
  return shapes_;
}

const gl::Buffer& GpuStrands::accelerations() {
  accelerated_ = true;
  return guides_;
}

std::vector<Vec3> GpuStrands::downloadAccelerations() const {
  std::vector<Vec3> out(vertices_);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(guides_.id(), 0, static_cast<GLsizeiptr>(vertices_ * sizeof(Vec3)), out.data());
  return out;
}

void GpuStrands::prepareAccelerations() {
  velocities_packed_.resize(vertices_);
  velocities_read_.resize(vertices_);
}

std::span<const Vec3> GpuStrands::velocities() {
  if (vertices_ == 0) return {};
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(velocities_.id(), 0, static_cast<GLsizeiptr>(vertices_ * sizeof(Vec4)),
                          velocities_packed_.data());
  for (size_t i = 0; i < vertices_; ++i)
    velocities_read_[i] = Vec3(velocities_packed_[i][0], velocities_packed_[i][1], velocities_packed_[i][2]);
  return velocities_read_;
}

std::span<const Vec3> GpuStrands::guidesOf(size_t first, size_t count) {
  if (uploaded_.empty() && accelerated_ && !guides_read_) {  // guides_ holds accelerations
    std::vector<Vec4> packed(vertices_);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(positions_.id(), 0, static_cast<GLsizeiptr>(vertices_ * sizeof(Vec4)),
                            packed.data());
    for (const Vec4& p : packed) uploaded_.emplace_back(p[0], p[1], p[2]);
  }
  if (!uploaded_.empty() || vertices_ == 0) return uploaded_;
  if (!guides_read_) {
    if (count > 0) readback_.copyFrom(guides_, first * sizeof(Vec3), count * sizeof(Vec3));
    readback_.wait();
    guides_read_ = count == vertices_;
    timer_.poll();
  }
  return readback_.as<Vec3>().first(vertices_);
}

std::span<const PackedRun> GpuStrands::packGuides(const GuideGrid& grid, const PackingFrame& frame) {
  if (accelerated_ || vertices_ == 0) return {};
  if (!packer_ || packer_->gridNumber() != grid.number) {
    packer_.reset();
    packing_started_ = false;
    packer_.emplace(model_, grid, programs_);
  }
  packs_steps_ = true;
  origin_ = frame.origin;
  if (!uploaded_.empty()) guides_.write(std::span<const Vec3>(uploaded_));
  if (!packing_started_ || !(packer_->frame() == frame)) packer_->start(guides_, offsets_, frame);
  packing_started_ = uploaded_.empty();
  return packer_->finish();
}

bool GpuStrands::mayHaveDiverged() {
  if (!uploaded_.empty() || guides_read_ || accelerated_ || vertices_ == 0) return true;
  if (!divergence_) divergence_.emplace(model_);
  divergence_->start(guides_, offsets_, programs_);
  // Where the step before was packed this one probably will be: the GPU goes on while the CPU waits.
  if (packer_ && std::exchange(packs_steps_, false) && !packing_started_) {
    packer_->start(guides_, offsets_, {head_.rotation.toRotationMatrix(), head_.position + origin_, origin_});
    packing_started_ = true;
  }
  const bool found = divergence_->finish();
  timer_.poll();
  return found;
}

}  // namespace strandcast::gpu
