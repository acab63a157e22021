#include "gpu_compute/sample_tiles.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace strandcast::gpu {
namespace {

// Pieces per strand in a tile, at most. A strand with more is cut into tiles of about kSomePieces pieces, so
// that a tile still has several strands.
constexpr uint32_t kMaxPieces = 64, kSomePieces = 48;
constexpr float kPlacesPerCell = 4;  // resolution of the Morton order, per cell of the hair grid and axis
constexpr uint32_t kPlaceBits = 10;  // per axis

// Morton code (Morton 1966) of a position: near codes are near in space. `x` in the groom's frame, m.
uint32_t mortonOf(const HairLayout& layout, const Vec3& x) {
  const Vec3 place = (x - layout.corner) * (kPlacesPerCell / layout.cell);
  uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<uint32_t>(std::clamp(place[axis], 0.0f, float{(1u << kPlaceBits) - 1}));
    for (uint32_t bit = 0; bit < kPlaceBits; ++bit)
      code |= ((at >> bit) & 1u) << (3 * bit + static_cast<uint32_t>(axis));
  }
  return code;
}

auto cutOf(const StrandPieces& s) { return std::tuple(s.edges, s.pieces, s.parts); }

// Strand numbers, sorted by how strands are cut, then by the Morton code of their roots.
std::vector<uint32_t> orderOf(const StrandModel& model, const StrandSamples& samples,
                              const HairLayout& layout) {
  std::vector<uint32_t> codes(model.strands()), out(model.strands());
  for (size_t s = 0; s < model.strands(); ++s)
    codes[s] = mortonOf(layout, model.restPosition(s, model.offsets[s]));
  std::iota(out.begin(), out.end(), 0u);
  std::stable_sort(out.begin(), out.end(), [&](uint32_t a, uint32_t b) {
    return std::tuple(cutOf(samples.strands[a]), codes[a]) < std::tuple(cutOf(samples.strands[b]), codes[b]);
  });
  return out;
}

// Approximate rest position of piece p of a strand, m.
Vec3 restingPlace(const StrandModel& model, uint32_t s, const StrandPieces& cut, uint32_t p) {
  const uint32_t parts = cut.parts;
  const uint32_t first = cut.vertex + cut.firstEdge(p);
  const uint32_t last = parts > 1 ? first + 1 : cut.vertex + cut.firstEdge(p + 1);
  const Vec3 x = model.restPosition(s, first);
  const float at = (static_cast<float>(p % parts) + 0.5f) / static_cast<float>(parts);
  return x + at * (model.restPosition(s, last) - x);
}

}  // namespace

SampleTiles sampleTiles(const StrandModel& model, const StrandSamples& samples, const HairLayout& layout) {
  SampleTiles out;
  out.places.resize(samples.samples.size());
  const std::vector<uint32_t> strands = orderOf(model, samples, layout);
  for (const uint32_t strand : strands) out.roots.push_back(samples.strands[strand].vertex);
  std::vector<std::array<uint32_t, 3>> inside;  // samples of a tile: Morton code, piece, strand
  for (uint32_t first = 0; first < strands.size();) {
    const StrandPieces& cut = samples.strands[strands[first]];
    const uint32_t all = cut.pieces, parts = cut.parts;
    const uint32_t at_once = all <= kMaxPieces ? all : kSomePieces / parts * parts;
    const uint32_t margin = at_once < all ? parts : 0;
    const uint32_t most = kTileSamples / (at_once + margin);
    uint32_t count = 1;
    while (count < most && first + count < strands.size() &&
           cutOf(samples.strands[strands[first + count]]) == cutOf(cut))
      ++count;
    for (uint32_t piece = 0; piece < all; piece += at_once) {
      const uint32_t pieces = std::min(at_once, all - piece);
      const auto start = static_cast<uint32_t>(out.tiles.size()) * kTileSamples;
      out.tiles.push_back({first, count, piece, pieces, cut.edges, all, parts, piece > 0 ? margin : 0});
      inside.clear();
      for (uint32_t p = 0; p < pieces; ++p)
        for (uint32_t s = 0; s < count; ++s) {
          const uint32_t strand = strands[first + s];
          inside.push_back(
              {mortonOf(layout, restingPlace(model, strand, samples.strands[strand], piece + p)), p, s});
        }
      std::sort(inside.begin(), inside.end());
      out.order.resize(start + kTileSamples);
      for (uint32_t n = 0; n < inside.size(); ++n) {
        const auto [code, p, s] = inside[n];
        out.order[start + n] = s + (p << 16);
        out.places[samples.strands[strands[first + s]].sample + piece + p] = start + n;
      }
    }
    first += count;
  }
  return out;
}

}  // namespace strandcast::gpu
