#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "transport/chunks.h"

namespace strandcast {

/// Nearest integer of x, ties to even; |x| <= 2^22. At 1.5 * 2^23 the spacing of floats is 1, so that the sum
/// rounds. (lrintf may set errno, and is therefore a library call in every build.)
inline int32_t nearest(float x) {
  constexpr float kShift = 12582912.0f;
  return std::bit_cast<int32_t>(x + kShift) - std::bit_cast<int32_t>(kShift);
}

/// The 16-bit symbols of one chunk's guides, plane after plane.
struct GuideSymbols {
  int edge_planes = 3;          ///< 3: differences of positions; 2: octahedral coordinates or tangent steps
  std::vector<uint16_t> roots;  ///< 3 planes (x, y, z) with one symbol per strand
  /// edge_planes planes with one symbol per vertex that is not a root, strand by strand. Tangent steps are
  /// not planes but pairs (u, v) per vertex.
  std::vector<uint16_t> edges;
};

/// How symbols become residuals: differences to a prediction, modulo 2^bits.
struct SymbolPrediction {
  bool along_strand = false;              ///< edges: predicted from the edge before
  int edge_bits = 16;                     ///< 12 or 16; roots always have 16
  std::span<const uint32_t> strand_ends;  ///< per strand, the end of its edges within a plane; ascending
};

/// What encoder and decoder share; docs/wire.md, "Payloads", describes the payload.

inline constexpr size_t kPayloadHeadBytes = 8;
/// Bits of the first byte of every payload but float32's.
enum PayloadMode : uint8_t {
  kAlongStrand = 1,  ///< edges are predicted from the edge before; not in Encoding::kTangent
  kInBlocks = 2      ///< symbols are in blocks of bits (bit_blocks.h), always in Encoding::kTangent; else
                     ///< compressed with zstd
};

/// Lower bound on the length by which tangent steps are divided; an edge this short has no visible direction.
inline constexpr float kShortestCodedEdge = 1e-9f;  // m

inline constexpr float kMaxGridStep = 0.01f;  // m
inline constexpr int32_t kMaxGridIndex =
    1 << 22;  // indices up to this are exact as floats, and within the range of nearest()

/// Nearest grid index of a coordinate in steps; clamped to +-kMaxGridIndex. NaN becomes an end of that range.
/// Encoders multiply by the reciprocal of the step: GPUs do not round quotients correctly.
inline int32_t gridIndex(float steps) {
  constexpr auto kMax = static_cast<float>(kMaxGridIndex);
  return nearest(std::min(kMax, std::max(-kMax, steps)));
}
/// Grid index of a root's coordinate at rest, m. The quotient is part of the format: both ends need the same
/// index.
inline int32_t restGridIndex(float position, float step) { return gridIndex(position / step); }
inline float gridPosition(int32_t index, float step) { return static_cast<float>(index) * step; }

/// Transforms between the world and the frame of the head, in which guides are encoded.
class HeadFrame {
 public:
  explicit HeadFrame(const Pose& head)
      : rotation_(head.rotation.toRotationMatrix()), position_(head.position) {}
  Vec3 toWorld(const Vec3& local) const { return rotation_ * local + position_; }
  Vec3 toHead(const Vec3& world) const { return rotation_.transpose() * (world - position_); }
  const auto& rotation() const { return rotation_; }
  const Vec3& position() const { return position_; }

 private:
  Eigen::Matrix<float, 3, 3, Eigen::DontAlign> rotation_;
  Vec3 position_;
};

/// What both ends know of a groom: topology, roots at rest and edge lengths.
struct GuideGeometry {
  std::vector<uint32_t> offsets;  ///< strands + 1
  std::vector<Vec3> roots;        ///< per strand, m, at rest in the head's frame
  std::vector<float> lengths;     ///< per vertex, m: of the edge that ends there; 0 at a root
  std::vector<Vec3> directions;  ///< per vertex, unit: of that edge at rest; (0, 1, 0) where it has no length

  GuideGeometry() = default;
  explicit GuideGeometry(const StrandSet& guides)
      : offsets(guides.offsets), lengths(guides.vertices()), directions(guides.vertices(), Vec3(0, 1, 0)) {
    for (size_t s = 0; s < guides.strands(); ++s) {
      const std::span<const Vec3> strand = guides.strand(s);
      roots.push_back(strand[0]);
      for (size_t i = 1; i < strand.size(); ++i) {
        // The order of the sum is part of the format: predictions must have the same bits at both ends.
        const Vec3 edge = strand[i] - strand[i - 1];
        const float length = std::sqrt(edge.x() * edge.x() + edge.y() * edge.y() + edge.z() * edge.z());
        lengths[offsets[s] + i] = length;
        if (length > kShortestCodedEdge) directions[offsets[s] + i] = edge * (1 / length);
      }
    }
  }
};

inline int edgePlanes(Encoding encoding) { return encoding == Encoding::kDelta16 ? 3 : 2; }
inline int edgeBits(Encoding encoding) { return encoding == Encoding::kOctahedral12 ? 12 : 16; }

/// Resizes `symbols` for a run.
inline void shapeSymbols(const StrandRun& run, Encoding encoding, GuideSymbols& symbols) {
  symbols.edge_planes = edgePlanes(encoding);
  symbols.roots.resize(3 * size_t{run.strand_count});
  symbols.edges.resize(static_cast<size_t>(symbols.edge_planes) * (run.vertex_count - run.strand_count));
}

}  // namespace strandcast
