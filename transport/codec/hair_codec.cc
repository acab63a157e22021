#include "transport/codec/hair_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "transport/codec/bit_blocks.h"
#include "transport/codec/guide_payload.h"

namespace strandcast {
namespace {

/// Planes of the payload, in its order. Names with several planes name the first.
enum Plane : size_t {
  kVertexCounts = 0,
  kFirstGuides = 1,  // low, high
  kOtherGuides = 3,  // of the second: low, high; of the third
  kWeights = 7,      // of the second, of the third
  kRoots = 9,        // x, y, z
  kEdges = 12,       // x, y, z
  kRadii = 15,
  kUvs = 16,      // u, v
  kColours = 18,  // R, G, B
  kParts = 21,
  kIds = 22,  // low, high
  kPlanes = 24
};

/// How many numbers a plane of the chunk has.
size_t sizeOfPlane(size_t plane, const HairChunk& chunk) {
  const size_t hairs = chunk.hair_count;
  const auto present = [&](HairChunk::Arrays array) { return (chunk.arrays & array) != 0; };
  if (plane < kEdges) return hairs;
  if (plane < kRadii) return chunk.vertex_count - hairs;
  if (plane < kUvs) return present(HairChunk::kRadii) ? chunk.vertex_count : 0;
  if (plane < kColours) return present(HairChunk::kUvs) ? hairs : 0;
  if (plane < kParts) return present(HairChunk::kColours) ? hairs : 0;
  if (plane < kIds) return present(HairChunk::kParts) ? hairs : 0;
  return present(HairChunk::kIds) ? hairs : 0;
}

float plainDot(const Vec3& a, const Vec3& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }

/// Predicts the edges of one hair from the root to the tip. Both ends need the same bits, so the order of all
/// operations is part of the format.
class HairPrediction {
 public:
  /// `vertices`: of the hair, 2 or more.
  HairPrediction(std::span<const Vec3> guide, uint32_t vertices)
      : guide_(guide), vertices_(vertices), on_guide_(guide.front()) {}

  /// Of the next edge, m. `before`: the decoded edge before it; ignored for the first.
  Vec3 next(const Vec3& before) {
    const Vec3 at = pointOfGuide(++vertex_), own = at - on_guide_;
    on_guide_ = at;
    const float own_length = std::sqrt(plainDot(own_before_, own_before_));
    const float length = std::sqrt(plainDot(before, before));
    const Vec3 from = own_before_;
    own_before_ = own;
    if (vertex_ == 1 || !(own_length > kShortestCodedEdge) || !(length > kShortestCodedEdge)) return own;
    const float scale = std::min(4.0f, std::max(0.25f, length / own_length));
    return turned(own, from * (1 / own_length), before * (1 / length)) * scale;
  }

 private:
  /// As in quantization.inl.
  static Vec3 turned(const Vec3& a, const Vec3& from, const Vec3& to) {
    const float cosine = plainDot(from, to);
    if (!(cosine > -0.9f)) return a;
    const Vec3 both = from + to;
    const Vec3 less = a - both * (plainDot(both, a) / (1 + cosine));
    return less + to * (2 * plainDot(from, a));
  }
  /// Of the guide, at the share of its edges that `vertex` has of the hair's.
  Vec3 pointOfGuide(uint32_t vertex) const {
    const auto edges = static_cast<uint32_t>(guide_.size() - 1), own_edges = vertices_ - 1;
    if (edges == 0) return guide_.front();
    const uint32_t place = vertex * edges;  // of 3500 x 3500 at most
    const uint32_t i = std::min(place / own_edges, edges - 1);
    const float part = static_cast<float>(place - i * own_edges) / static_cast<float>(own_edges);
    return guide_[i] + (guide_[i + 1] - guide_[i]) * part;
  }

  std::span<const Vec3> guide_;
  uint32_t vertices_, vertex_ = 0;
  Vec3 on_guide_, own_before_ = Vec3::Zero();
};

Vec3 stepped(const Vec3& from, const Vec3& predicted, const Vec3& steps, float step) {
  return (from + predicted) + steps * step;
}

int16_t lowHalf(uint32_t number) { return static_cast<int16_t>(number); }
/// So that number = 65536 high + low modulo 2^32, both signed: small numbers of either sign have high 0.
int16_t highHalf(uint32_t number) {
  return static_cast<int16_t>((number - static_cast<uint32_t>(int32_t{lowHalf(number)})) >> 16);
}
uint32_t fromHalves(uint16_t low, uint16_t high) {
  return (uint32_t{high} << 16) + static_cast<uint32_t>(int32_t{static_cast<int16_t>(low)});
}

/// Numbers of one plane, which know how many bytes they will take.
class PlaneNumbers {
 public:
  void add(int number) {
    const auto n = static_cast<uint16_t>(number);
    const size_t place = numbers_.size() % kBitBlockPair;
    if (place == 0) {
      bytes_before_ = bytes();
      any_ = {};
    }
    any_[place / kBitBlock] |= zigzag(n);
    numbers_.push_back(n);
  }
  size_t bytes() const { return numbers_.empty() ? 0 : bytes_before_ + 1 + width(any_[0]) + width(any_[1]); }
  /// Drops the numbers behind the first `count`; bytes() is no longer right then.
  void cut(size_t count) { numbers_.resize(count); }
  void clear() { *this = {}; }
  const std::vector<uint16_t>& numbers() const { return numbers_; }

 private:
  static uint32_t width(uint32_t any) {
    const auto bits = static_cast<uint32_t>(std::bit_width(any));
    return bits == kWidestCode ? kMaxBlockWidth : bits;
  }
  std::vector<uint16_t> numbers_;
  size_t bytes_before_ = 0;  // of the pairs before the last
  std::array<uint32_t, 2> any_{};
};

/// What all chunks of one description share.
struct HairGrid {
  float step, radius_step;
  std::array<float, 4> uv_box;
};

/// Where an error is: the source of the hairs, if it is known, and `what` about them.
std::string placeOf(const HairDescription& hairs, const std::string& what) {
  return hairs.source.empty() ? what : hairs.source + ", " + what;
}

/// Throws Error.
HairGrid gridOf(const HairDescription& hairs, float max_error) {
  // A vertex is off by half the diagonal of a cell, and by the rounding of its last sum: on each axis by at
  // most one unit in the last place of the largest coordinate. 0.5 % are for the quotient in putSteps().
  float largest = 0;
  for (const Vec3& p : hairs.hairs.positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const float rounding = std::sqrt(3.0f) * largest * std::numeric_limits<float>::epsilon();
  const float bound = std::min(0.95f * max_error, 0.995f * max_error - rounding);
  HairGrid grid{std::min(bound * (2 / std::sqrt(3.0f)), kMaxHairStep), 0, {}};
  if (!(grid.step >= kMinHairStep))
    throw Error("hairs lie too far from the origin for the wanted error",
                placeOf(hairs, std::to_string(largest) + " m away"),
                "check the unit (--unit-meters), move the groom to the origin, or allow a larger error "
                "(--hair-error)");
  float thickest = 0;
  for (const float radius : hairs.hairs.radii) thickest = std::max(thickest, radius);
  grid.radius_step = std::max(20e-9f, thickest / 32767);
  if (!hairs.hairs.uvs.empty()) {
    Vec2 low = hairs.hairs.uvs.front(), high = low;
    for (const Vec2& uv : hairs.hairs.uvs) low = low.cwiseMin(uv), high = high.cwiseMax(uv);
    grid.uv_box = {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()};
  }
  return grid;
}

/// Collects hairs until the chunk is full.
class HairCollector {
 public:
  HairCollector(const HairDescription& hairs, const StrandSet& guides, const HairGrid& grid)
      : hairs_(hairs), guides_(guides), grid_(grid) {}

  /// Adds hair `h` unless the payload would exceed kMaxChunkBytes; a single hair never does. Throws Error.
  bool add(size_t h) {
    std::array<size_t, kPlanes> before;
    for (size_t p = 0; p < kPlanes; ++p) before[p] = planes_[p].numbers().size();
    addBinding(h);
    addVertices(h);
    addArrays(h);
    size_t bytes = 0;
    for (const PlaneNumbers& plane : planes_) bytes += plane.bytes();
    if (bytes > kMaxChunkBytes) {
      for (size_t p = 0; p < kPlanes; ++p) planes_[p].cut(before[p]);
      return false;
    }
    last_ = h;
    return true;
  }

  std::vector<uint8_t> packed(const StrandCoder& coder) const {
    std::vector<uint8_t> bytes;
    for (const PlaneNumbers& plane : planes_) {
      const size_t before = bytes.size();
      bytes.resize(before + maxPackedBytes(plane.numbers().size()));
      bytes.resize(static_cast<size_t>(coder.pack(plane.numbers(), bytes.data() + before) - bytes.data()));
    }
    return bytes;
  }

  void clear() {
    for (PlaneNumbers& plane : planes_) plane.clear();
    last_ = kNone;
  }

 private:
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  void put(size_t plane, int number) { planes_[plane].add(number); }
  void putHalves(size_t plane, uint32_t difference) {
    put(plane, lowHalf(difference));
    put(plane + 1, highHalf(difference));
  }
  /// value(hair) minus that of the hair before, 0 before the first.
  template <class Value>
  auto sinceLast(size_t h, Value value) const {
    return last_ == kNone ? value(h) : value(h) - value(last_);
  }

  void addBinding(size_t h) {
    const HairBinding& binding = hairs_.bindings[h];
    put(kVertexCounts, sinceLast(h, [&](size_t s) { return static_cast<int>(hairs_.hairs.verticesOf(s)); }));
    putHalves(kFirstGuides, sinceLast(h, [&](size_t s) { return hairs_.bindings[s].guides[0]; }));
    for (size_t k = 1; k < 3; ++k) {
      putHalves(kOtherGuides + 2 * (k - 1), binding.guides[k] - binding.guides[0]);
      put(kWeights + k - 1, binding.weights[k - 1]);
    }
  }

  void addVertices(size_t h) {
    const std::span<const Vec3> points = hairs_.hairs.strand(h);
    const std::span<const Vec3> guide = guides_.strand(hairs_.bindings[h].guides[0]);
    HairPrediction prediction(guide, static_cast<uint32_t>(points.size()));
    Vec3 decoded =
        stepped(guide.front(), Vec3::Zero(), putSteps(h, kRoots, points[0] - guide.front()), grid_.step);
    Vec3 edge = Vec3::Zero();
    for (size_t j = 1; j < points.size(); ++j) {
      const Vec3 predicted = prediction.next(edge);
      const Vec3 steps = putSteps(h, kEdges, points[j] - (decoded + predicted));
      const Vec3 now = stepped(decoded, predicted, steps, grid_.step);
      edge = now - decoded;
      decoded = now;
    }
  }
  /// Returns the numbers of steps. Throws Error where they need more than 16 bits.
  Vec3 putSteps(size_t h, size_t plane, const Vec3& residual) {
    Vec3 steps;
    for (size_t c = 0; c < 3; ++c) {
      const int32_t n = gridIndex(residual[static_cast<Eigen::Index>(c)] / grid_.step);
      if (n != static_cast<int16_t>(n))
        throw Error("a hair lies too far from its guide for the wanted error", whereIs(h, residual),
                    "check the unit of the hairs' file (--unit-meters), give guides near the hair, or allow "
                    "a larger error (--hair-error)");
      put(plane + c, n);
      steps[static_cast<Eigen::Index>(c)] = static_cast<float>(n);
    }
    return steps;
  }

  std::string whereIs(size_t h, const Vec3& residual) const {
    const Vec3 root = hairs_.hairs.strand(h)[0];
    std::ostringstream text;
    text << std::setprecision(3) << "hair " << h << " with its root at " << root.x() << ' ' << root.y() << ' '
         << root.z() << ", " << residual.norm() << " m";
    return placeOf(hairs_, text.str());
  }

  void addArrays(size_t h) {
    const StrandSet& strands = hairs_.hairs;
    if (!strands.radii.empty()) {
      const auto radius = [&](size_t v) { return nearest(strands.radii[v] / grid_.radius_step); };
      put(kRadii, sinceLast(h, [&](size_t s) { return radius(strands.offsets[s]); }));
      for (size_t v = strands.offsets[h] + 1; v < strands.offsets[h + 1]; ++v)
        put(kRadii, radius(v) - radius(v - 1));
    }
    for (size_t c = 0; c < 2 && !strands.uvs.empty(); ++c)
      put(kUvs + c, sinceLast(h, [&](size_t s) { return gridOfUv(s, c); }));
    for (size_t c = 0; c < 3 && !hairs_.colours.empty(); ++c)
      put(kColours + c, sinceLast(h, [&](size_t s) { return int{hairs_.colours[s][c]}; }));
    if (!strands.parts.empty()) put(kParts, sinceLast(h, [&](size_t s) { return int{strands.parts[s]}; }));
    if (!hairs_.ids.empty()) putHalves(kIds, sinceLast(h, [&](size_t s) { return hairs_.ids[s]; }));
  }
  int gridOfUv(size_t s, size_t c) const {
    const float size = grid_.uv_box[2 + c];
    const float offset = hairs_.hairs.uvs[s][static_cast<Eigen::Index>(c)] - grid_.uv_box[c];
    return size > 0 ? nearest(std::clamp(offset / size, 0.0f, 1.0f) * 65535) : 0;
  }

  const HairDescription& hairs_;
  const StrandSet& guides_;
  const HairGrid grid_;
  std::array<PlaneNumbers, kPlanes> planes_;
  size_t last_ = kNone;  // hair of the chunk
};

}  // namespace

void checkHairs(const HairDescription& hairs, const StrandSet& guides, const std::string& where) {
  const StrandSet& strands = hairs.hairs;
  checkStrandSet(strands, where);
  const auto fits = [&](size_t size) { return size == 0 || size == strands.strands(); };
  if (hairs.bindings.size() != strands.strands() || !fits(hairs.colours.size()) || !fits(hairs.ids.size()))
    throw Error("an array of the hairs has the wrong length", where, "");
  if (strands.strands() == 0 || strands.strands() > kMaxHairs)
    throw Error("the number of hairs is not in 1 to 4 million", where, "bind other hairs");
  for (size_t s = 0; s < strands.strands(); ++s) {
    const auto refuse = [&](const std::string& what, const char* remedy) {
      throw Error(what, where + ", hair " + std::to_string(s), remedy);
    };
    const HairBinding& binding = hairs.bindings[s];
    const size_t vertices = strands.verticesOf(s);
    if (vertices < kMinVerticesPerHair || vertices > kMaxWireVertices)
      refuse("a hair has " + std::to_string(vertices) + " vertices, not 2 to 3500", "resample it");
    if (std::ranges::any_of(binding.guides, [&](uint32_t g) { return g >= guides.strands(); }))
      refuse("a hair follows a guide that does not exist", "bind it to guides of this groom");
    if (binding.weights[0] + binding.weights[1] > 255) refuse("weights of a hair sum to more than 1", "");
  }
  if (!std::ranges::all_of(strands.radii, isHairRadius))
    throw Error("a radius is not in 0 to 0.01 m", where, "give it in metres");
}

std::vector<HairChunk> encodeHairs(const HairDescription& hairs, const StrandSet& guides, float max_error,
                                   const StrandCoder& coder) {
  const StrandSet& strands = hairs.hairs;
  const HairGrid grid = gridOf(hairs, max_error);
  HairChunk head;
  head.session = hairs.session;
  head.groom_id = hairs.groom_id;
  head.revision = hairs.revision;
  head.total_hairs = static_cast<uint32_t>(strands.strands());
  head.total_vertices = static_cast<uint32_t>(strands.vertices());
  head.arrays = (strands.radii.empty() ? 0u : HairChunk::kRadii) |
                (strands.uvs.empty() ? 0u : HairChunk::kUvs) |
                (hairs.colours.empty() ? 0u : HairChunk::kColours) |
                (strands.parts.empty() ? 0u : HairChunk::kParts) | (hairs.ids.empty() ? 0u : HairChunk::kIds);
  head.step = grid.step;
  head.radius_step = grid.radius_step;
  head.uv_box = grid.uv_box;

  std::vector<HairChunk> chunks;
  HairCollector collector(hairs, guides, grid);
  for (uint32_t h = 0; h < strands.strands();) {
    HairChunk& chunk = chunks.emplace_back(head);
    chunk.chunk_index = static_cast<uint32_t>(chunks.size() - 1);
    chunk.first_hair = h;
    chunk.first_vertex = strands.offsets[h];
    while (h < strands.strands() && collector.add(h)) ++h;
    chunk.hair_count = h - chunk.first_hair;
    chunk.vertex_count = strands.offsets[h] - chunk.first_vertex;
    chunk.payload = collector.packed(coder);
    collector.clear();
  }
  if (chunks.size() > kMaxChunks)
    throw Error("the hairs are too many for the network",
                placeOf(hairs, std::to_string(strands.strands()) + " hairs"),
                "give fewer hairs or allow a larger error (--hair-error)");
  for (HairChunk& chunk : chunks) chunk.chunk_count = static_cast<uint32_t>(chunks.size());
  return chunks;
}

bool isSoundHead(const HairChunk& chunk) {
  constexpr uint32_t kAll =
      HairChunk::kRadii | HairChunk::kUvs | HairChunk::kColours | HairChunk::kParts | HairChunk::kIds;
  const auto in = [](float value, float least, float most) { return value >= least && value <= most; };
  return chunk.encoding == 0 && (chunk.arrays & ~kAll) == 0 && chunk.hair_count > 0 &&
         uint64_t{chunk.vertex_count} >= uint64_t{chunk.hair_count} * kMinVerticesPerHair &&
         in(chunk.step, kMinHairStep, kMaxHairStep) &&
         in(chunk.radius_step, kMinRadiusStep, kMaxRadiusStep) &&
         std::ranges::all_of(chunk.uv_box, [](float number) { return std::isfinite(number); });
}

namespace {

/// The planes of a payload. Sums of differences are checked as they are formed.
class HairReader {
 public:
  HairReader(const HairChunk& chunk, const StrandSet& guides) : chunk_(chunk), guides_(guides) {}

  bool unpack(const StrandCoder& coder) {
    // A pair of blocks takes one byte or more. This bounds what the counts of the chunk can allocate.
    size_t least = 0;
    for (size_t p = 0; p < kPlanes; ++p)
      least += (sizeOfPlane(p, chunk_) + kBitBlockPair - 1) / kBitBlockPair;
    if (chunk_.payload.size() < least) return false;
    std::span<const uint8_t> bytes = chunk_.payload;
    for (size_t p = 0; p < kPlanes; ++p) {
      planes_[p].resize(sizeOfPlane(p, chunk_));
      if (!coder.unpack(bytes, planes_[p])) return false;
    }
    return bytes.empty();
  }

  /// Appends to hairs.bindings and hairs.hairs.offsets.
  bool readBindings(HairDescription& hairs) const {
    int64_t vertices = 0, taken = 0;
    uint32_t first = 0;
    for (size_t h = 0; h < chunk_.hair_count; ++h) {
      vertices += at(kVertexCounts, h);
      if (vertices < int64_t{kMinVerticesPerHair} || vertices > int64_t{kMaxWireVertices}) return false;
      taken += vertices;
      if (taken > chunk_.vertex_count) return false;
      hairs.hairs.offsets.push_back(hairs.hairs.offsets.back() + static_cast<uint32_t>(vertices));
      first += wholeAt(kFirstGuides, h);
      HairBinding binding{{first, first + wholeAt(kOtherGuides, h), first + wholeAt(kOtherGuides + 2, h)},
                          {}};
      for (const uint32_t g : binding.guides)
        if (g >= guides_.strands()) return false;
      const int second = at(kWeights, h), third = at(kWeights + 1, h);
      if (second < 0 || third < 0 || second + third > 255) return false;
      binding.weights = {static_cast<uint8_t>(second), static_cast<uint8_t>(third)};
      hairs.bindings.push_back(binding);
    }
    return taken == chunk_.vertex_count;
  }

  /// Appends to hairs.hairs.positions; after readBindings().
  bool readPositions(HairDescription& hairs) const {
    StrandSet& strands = hairs.hairs;
    const size_t first = strands.strands() - chunk_.hair_count;
    size_t edge_number = 0;
    for (size_t h = 0; h < chunk_.hair_count; ++h) {
      const std::span<const Vec3> guide =
          guides_.strand(hairs.bindings[hairs.bindings.size() - chunk_.hair_count + h].guides[0]);
      const auto vertices = static_cast<uint32_t>(strands.verticesOf(first + h));
      HairPrediction prediction(guide, vertices);
      Vec3 decoded = stepped(guide.front(), Vec3::Zero(), stepsAt(kRoots, h), chunk_.step),
           edge = Vec3::Zero();
      strands.positions.push_back(decoded);
      for (uint32_t j = 1; j < vertices; ++j) {
        const Vec3 now = stepped(decoded, prediction.next(edge), stepsAt(kEdges, edge_number++), chunk_.step);
        edge = now - decoded;
        decoded = now;
        strands.positions.push_back(decoded);
      }
    }
    return std::all_of(strands.positions.end() - chunk_.vertex_count, strands.positions.end(),
                       [](const Vec3& p) { return p.allFinite(); });
  }

  /// Appends to the arrays that the chunk has; after readBindings().
  bool readArrays(HairDescription& hairs) const {
    if ((chunk_.arrays & HairChunk::kRadii) != 0 && !readRadii(hairs.hairs)) return false;
    std::array<uint16_t, 2> uv{};
    std::array<int, 3> colour{};
    uint16_t part = 0;
    uint32_t id = 0;
    for (size_t h = 0; h < chunk_.hair_count; ++h) {
      if ((chunk_.arrays & HairChunk::kUvs) != 0) {
        Vec2& place = hairs.hairs.uvs.emplace_back();
        for (size_t c = 0; c < 2; ++c) {
          uv[c] = static_cast<uint16_t>(uv[c] + at(kUvs + c, h));
          place[static_cast<Eigen::Index>(c)] =
              chunk_.uv_box[c] + chunk_.uv_box[2 + c] * (static_cast<float>(uv[c]) / 65535);
        }
        if (!place.allFinite()) return false;
      }
      if ((chunk_.arrays & HairChunk::kColours) != 0) {
        auto& own = hairs.colours.emplace_back();
        for (size_t c = 0; c < 3; ++c) {
          colour[c] += at(kColours + c, h);
          if (colour[c] < 0 || colour[c] > 255) return false;
          own[c] = static_cast<uint8_t>(colour[c]);
        }
      }
      part = static_cast<uint16_t>(part + at(kParts, h));
      if ((chunk_.arrays & HairChunk::kParts) != 0) hairs.hairs.parts.push_back(part);
      if ((chunk_.arrays & HairChunk::kIds) != 0) hairs.ids.push_back(id += wholeAt(kIds, h));
    }
    return true;
  }

 private:
  /// As a signed number; 0 where the chunk lacks the plane.
  int at(size_t plane, size_t i) const {
    return planes_[plane].empty() ? 0 : static_cast<int16_t>(planes_[plane][i]);
  }
  uint32_t wholeAt(size_t plane, size_t i) const {
    return fromHalves(planes_[plane][i], planes_[plane + 1][i]);
  }
  Vec3 stepsAt(size_t plane, size_t i) const {
    return {static_cast<float>(at(plane, i)), static_cast<float>(at(plane + 1, i)),
            static_cast<float>(at(plane + 2, i))};
  }

  bool readRadii(StrandSet& strands) const {
    const size_t first = strands.strands() - chunk_.hair_count;
    int root = 0;  // in steps
    size_t number = 0;
    for (size_t h = first; h < strands.strands(); ++h) {
      int radius = root;
      for (size_t j = 0; j < strands.verticesOf(h); ++j) {
        radius += at(kRadii, number++);
        const float metres = static_cast<float>(radius) * chunk_.radius_step;
        // Rounding may take the thickest hair past its limit.
        if (!(metres >= 0 && metres <= 1.001f * kThickestHair)) return false;
        if (j == 0) root = radius;
        strands.radii.push_back(std::min(metres, kThickestHair));
      }
    }
    return true;
  }

  const HairChunk& chunk_;
  const StrandSet& guides_;
  std::array<std::vector<uint16_t>, kPlanes> planes_;
};

}  // namespace

bool decodeHairs(const HairChunk& chunk, const StrandSet& guides, HairDescription& hairs,
                 const StrandCoder& coder) {
  if (!isSoundHead(chunk)) return false;
  HairReader reader(chunk, guides);
  return reader.unpack(coder) && reader.readBindings(hairs) && reader.readPositions(hairs) &&
         reader.readArrays(hairs);
}

}  // namespace strandcast
