#pragma once
#include <array>
#include <cstdint>

#include "gl/buffer.h"

namespace strandcast::gpu {

/// The uniform block of shaders/air_settings.glsl, std140. That file has the units of its members.
struct AirSettings {
  using Vec4 = std::array<float, 4>;
  using Rows = std::array<Vec4, 3>;
  Rows hair_frame;
  Rows turn;
  Rows wind_of_hair;
  Vec4 wind_box;
  Vec4 ambient_mean;
  Vec4 ambient_carried;
  Vec4 uniform_wind;
  int32_t cells;
  int32_t open_border;
  int32_t bodies;
  int32_t sources;
  uint32_t tiles;
  float seconds;
  float courant;
  float mass_scale;
  float per_volume;
  float mass;
  float stiffness;
  float gain;
  float rest_scale;
  float crowd_scale;
  float slope;
  float friction;
  float alone;
  float exchange;
  float drag;
  int32_t shift[3];
  int32_t spheres;
  int32_t padding;
};
static_assert(sizeof(AirSettings) == 304);

/// The settings of the air's passes and their uniform buffer. Needs a current context for its whole life.
class AirBlock {
 public:
  AirBlock() : buffer_(sizeof(AirSettings), nullptr, GL_DYNAMIC_STORAGE_BIT) {}
  AirSettings settings{};
  /// Copies `settings` to the GPU for later commands, and binds the block.
  void send() {
    buffer_.write(std::span<const AirSettings>(&settings, 1));
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, buffer_.id());
  }

 private:
  gl::Buffer buffer_;
};

/// Hair as a momentum source of the air: the output of HairPasses that WindPasses reads. The buffers must
/// outlive it.
struct HairOnAir {
  const gl::Buffer& nodes;      ///< 4 floats per node: momentum, kg/(m^2 s), and mass, kg/m^3, per volume
  const gl::Buffer* slip_sums;  ///< sums of shaders/hair_slip.comp; null: air does not slip along hair
  const gl::Buffer* fastest;    ///< Fastest of shaders/hair_samples.glsl, the unit of slip_sums
};

/// A buffer of `count` values of T, filled with zero bits.
template <class T>
gl::Buffer zeros(size_t count) {
  gl::Buffer buffer(count * sizeof(T), nullptr, GL_DYNAMIC_STORAGE_BIT);
  glClearNamedBufferData(buffer.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  return buffer;
}
/// Makes the storage buffer writes of earlier dispatches visible to later ones.
inline void finishPass() { glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); }
/// Workgroups for `count` items.
inline GLuint groupsOf(size_t count, size_t per_group) {
  return static_cast<GLuint>((count + per_group - 1) / per_group);
}

}  // namespace strandcast::gpu
