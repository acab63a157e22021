#pragma once
#include <cstdint>

namespace strandcast {

/// Limits on what one glTF file may expand to, however often its scene repeats a mesh and its clips their
/// data. A file above a limit is refused: without limits a few kilobytes could exhaust the memory. Genuine
/// bodies stay far below.
struct GltfLimits {
  uint64_t primitives = 2'000'000;
  uint64_t vertices = 20'000'000;
  uint64_t triangles = 40'000'000;
  uint64_t instances = 1'000'000;          ///< of nodes with EXT_mesh_gpu_instancing
  uint64_t target_vertices = 200'000'000;  ///< summed over the morph targets that are applied or played
  uint64_t clip_values = 100'000'000;      ///< numbers of all clips
  uint64_t accessor_bytes = 256'000'000;   ///< of one accessor that is sparse or has no bufferView
};

}  // namespace strandcast
