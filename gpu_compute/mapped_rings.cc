#include "gpu_compute/mapped_rings.h"

#include <cstring>

#include "core/error.h"

namespace strandcast::gpu {
namespace {

constexpr GLbitfield kWritten = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
constexpr GLbitfield kRead = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

// 256 bytes: the largest offset alignment that OpenGL 4.5 lets a device require.
size_t aligned(size_t bytes) { return (bytes + 255) / 256 * 256; }

void* map(const gl::Buffer& buffer, GLbitfield access) {
  void* memory = glMapNamedBufferRange(buffer.id(), 0, static_cast<GLsizeiptr>(buffer.bytes()), access);
  if (memory == nullptr)
    throw Error("the GPU has no memory to share with the CPU", std::to_string(buffer.bytes()) + " bytes",
                "use fewer strands or --backend simd");
  return memory;
}

}  // namespace

Fence::~Fence() {
  if (sync_ != nullptr) glDeleteSync(sync_);
}

void Fence::set() {
  if (sync_ != nullptr) glDeleteSync(sync_);
  sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

void Fence::wait() {
  if (sync_ == nullptr) return;
  constexpr GLuint64 kTenth = 100'000'000;  // ns, of a second
  while (glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, kTenth) == GL_TIMEOUT_EXPIRED) {
  }
  glDeleteSync(sync_);
  sync_ = nullptr;
}

UploadRing::Counts UploadRing::countsOf(const StepInput& input) {
  return {input.primitives.size() * static_cast<size_t>(input.parameters->substeps),
          input.near != nullptr ? 2 * (input.near->offsets.size() + input.near->bodies.size()) : 0};
}

UploadRing::UploadRing(const StrandModel& model, const Counts& capacity)
    : model_(model),
      capacity_(capacity),
      bodies_at_(aligned(sizeof(Settings))),
      near_at_(bodies_at_ + aligned(std::max<size_t>(capacity.bodies, 1) * sizeof(PlacedBody))),
      poses_at_(near_at_ + aligned(std::max<size_t>(capacity.near, 1) * sizeof(uint32_t))),
      bones_bytes_(2 * model.bones.size() * sizeof(Pose)),
      on_gpu_(poses_at_ + bones_bytes_ + model.strands() * sizeof(Pose), nullptr, GL_DYNAMIC_STORAGE_BIT) {
  for (size_t i = 0; i < kSlots; ++i) {
    buffers_[i] = gl::Buffer(poses_at_ + bones_bytes_, nullptr, kWritten);
    memory_[i] = static_cast<char*>(map(buffers_[i], kWritten));
  }
  leaders_.reserve(capacity.bodies);
  glNamedBufferSubData(on_gpu_.id(), static_cast<GLintptr>(poses_at_ + bones_bytes_),
                       static_cast<GLsizeiptr>(model.strands() * sizeof(Pose)), model.rest_roots.data());
}

void UploadRing::write(const StepInput& input) {
  slot_ = (slot_ + 1) % kSlots;
  fences_[slot_].wait();
  char* memory = memory_[slot_];
  const Settings settings = settingsOf(input, model_);
  std::memcpy(memory, &settings, sizeof settings);
  leaders_.groupByMotion(input.primitives);
  placeBodies(input, leaders_, reinterpret_cast<PlacedBody*>(memory + bodies_at_));
  if (input.near != nullptr) leaders_.writeLists(*input.near, reinterpret_cast<uint32_t*>(memory + near_at_));
  Pose* poses = reinterpret_cast<Pose*>(memory + poses_at_);
  for (size_t bone = 0; bone < model_.bones.size(); ++bone) *poses++ = input.boneAtBegin(bone);
  for (size_t bone = 0; bone < model_.bones.size(); ++bone) *poses++ = input.boneAtEnd(bone);

  const GLuint id = on_gpu_.id();
  glCopyNamedBufferSubData(buffers_[slot_].id(), id, 0, 0, static_cast<GLsizeiptr>(poses_at_ + bones_bytes_));
  fences_[slot_].set();
  constexpr GLsizeiptr kBlock = (sizeof(Settings) + 15) / 16 * 16;  // std140 rounds the size up to 16
  glBindBufferRange(GL_UNIFORM_BUFFER, 0, id, 0, kBlock);
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 6, id, static_cast<GLintptr>(poses_at_),
                    static_cast<GLsizeiptr>(on_gpu_.bytes() - poses_at_));
  glBindBufferRange(
      GL_SHADER_STORAGE_BUFFER, 7, id, static_cast<GLintptr>(bodies_at_),
      static_cast<GLsizeiptr>(std::max<size_t>(countsOf(input).bodies, 1) * sizeof(PlacedBody)));
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 15, id, static_cast<GLintptr>(near_at_),
                    static_cast<GLsizeiptr>(std::max<size_t>(countsOf(input).near, 1) * sizeof(uint32_t)));
}

Readback::Readback(size_t bytes)
    : buffer_(bytes, nullptr, kRead | GL_CLIENT_STORAGE_BIT), memory_(map(buffer_, kRead)) {}

void Readback::copyFrom(const gl::Buffer& from, size_t first, size_t bytes) {
  glCopyNamedBufferSubData(from.id(), buffer_.id(), static_cast<GLintptr>(first),
                           static_cast<GLintptr>(first), static_cast<GLsizeiptr>(bytes));
  fence_.set();
}

void Readback::wait() { fence_.wait(); }

}  // namespace strandcast::gpu
