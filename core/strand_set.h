// Public API
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Strands of any vertex counts in natural order: strand after strand, each from root to tip. Grooms are
/// loaded, guides published and backends filled in this form. Every array "per vertex" follows this order.
struct StrandSet {
  std::vector<uint32_t> offsets{
      0};  ///< strands + 1 entries; vertices of strand s are offsets[s] .. offsets[s + 1] - 1
  std::vector<Vec3> positions;  ///< per vertex, m
  std::vector<uint8_t>
      pinned;  ///< per vertex, 1 = moves with the root; empty = only root vertices are pinned
  /// Per vertex, m, 0 or more; may be empty. Stored for other renderers: the simulation and the renderer of
  /// this project use Material::radius and its taper.
  std::vector<float> radii;
  std::vector<Vec2> uvs;        ///< per strand, texture coordinates on the scalp; may be empty
  std::vector<uint16_t> parts;  ///< per strand, index of the file or group it came from; may be empty
  /// Labels that the artist gave the strands, each per strand or empty. The simulation does not use them.
  std::vector<uint32_t> ids;      ///< the artist's numbers (Unreal's groom_id)
  std::vector<uint8_t> is_guide;  ///< 1 = marked as a guide that other hairs follow
  std::vector<uint32_t> groups;   ///< index into the table of groups that the groom has beside its strands
  std::vector<Vec3> colours;      ///< linear RGB, 0 or more, usually at most 1

  size_t strands() const { return offsets.size() - 1; }
  size_t vertices() const { return positions.size(); }
  size_t verticesOf(size_t strand) const { return offsets[strand + 1] - offsets[strand]; }
  std::span<const Vec3> strand(size_t s) const { return {positions.data() + offsets[s], verticesOf(s)}; }
  std::span<Vec3> strand(size_t s) { return {positions.data() + offsets[s], verticesOf(s)}; }
  bool isPinned(size_t s, size_t i) const {
    return i == 0 || (!pinned.empty() && pinned[offsets[s] + i] != 0);
  }
  /// Appends one strand; `points` has 1 or more entries.
  void append(std::span<const Vec3> points);
};

/// The guides that a hair follows. The first has the weight that the others leave.
struct HairBinding {
  std::array<uint32_t, 3> guides{};  ///< strands of the groom's guides; the first again where a weight is 0
  std::array<uint8_t, 2> weights{};  ///< of the second and third guide, in 1/255; their sum is at most 255

  /// 0 to 1; k: 0 to 2. The three sum up to 1.
  double weight(size_t k) const { return (k == 0 ? 255 - weights[0] - weights[1] : weights[k - 1]) / 255.0; }
};

/// Throws Error, naming `where`, if arrays do not fit each other, a number is not finite or a radius or
/// colour is negative. A set without strands passes.
void checkStrandSet(const StrandSet& strands, const std::string& where);

/// Arc length of a strand, m.
float arcLength(std::span<const Vec3> points);

}  // namespace strandcast
