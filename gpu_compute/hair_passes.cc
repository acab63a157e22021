#include "gpu_compute/hair_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/error.h"
#include "gpu_compute/shaders.h"
#include "kernels/scalar_grid.h"

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

namespace {

using Vec4 = std::array<float, 4>;

constexpr GLuint kWide = 32768;  // workgroups along x of a dispatch, at most
constexpr int kTile = 8;         // nodes per axis of a workgroup, TILE of shaders/hair_tile.glsl

}  // namespace

HairPasses::HairPasses(const StrandModel& model, const Box& box, int cells, AirBlock& block,
                       ProgramCache& programs)
    : programs_(programs),
      layout_(hairLayout(box, cells)),
      nodes_count_(static_cast<size_t>(cells) * static_cast<size_t>(cells) * static_cast<size_t>(cells)) {
  const StrandSamples samples = strandSamples(model, layout_.cell);
  const SampleTiles tiles = sampleTiles(model, samples, layout_);
  tiles_ = tiles.tiles.size();
  if (tiles_ > size_t{kWide} * 65535 / kTileSamples)
    throw Error(fmt::format("{} strands have too many pieces for a GPU's grid", model.strands()),
                "grid_cells", "use fewer cells or --backend simd");
  const size_t places = tiles_ * kTileSamples;
  std::vector<std::array<float, 2>> resting(places);
  for (size_t n = 0; n < samples.samples.size(); ++n) {
    mass_ += static_cast<double>(samples.samples[n].mass);
    resting[tiles.places[n]] = {samples.samples[n].mass, 0};
  }
  sample_tiles_ = gl::Buffer(std::span<const SampleTile>(tiles.tiles));
  roots_ = gl::Buffer(std::span<const uint32_t>(tiles.roots));
  order_ = gl::Buffer(std::span<const uint32_t>(tiles.order));
  edge_masses_ = gl::Buffer(std::span<const std::array<float, 2>>(samples.edge_masses));
  resting_ = gl::Buffer(std::span<const std::array<float, 2>>(resting));
  held_ = zeros<float>(places);
  places_ = zeros<float>(3 * places);
  motions_ = zeros<float>(3 * places);
  fastest_ = zeros<uint32_t>(2);
  sums_ = zeros<int32_t>(4 * nodes_count_);
  crowd_sums_ = zeros<int32_t>(nodes_count_);
  densities_ = zeros<float>(nodes_count_);
  nodes_ = zeros<Vec4>(nodes_count_);
  changes_ = zeros<Vec4>(nodes_count_);
  rates_ = zeros<float>(1);
  makeDrag(model, samples);
  computeRestDensity(model, block);
}

void HairPasses::makeDrag(const StrandModel& model, const StrandSamples& samples) {
  drag_shares_ = dragShares(model, samples);
  if (!unevenlyDragged()) return;
  std::vector<std::array<float, 2>> masses = samples.edge_masses;
  for (const StrandPieces& strand : samples.strands)
    for (uint32_t p = 0; p < strand.pieces; p += strand.parts) {
      const uint32_t first = strand.firstEdge(p), end = strand.firstEdge(p + strand.parts);
      for (uint32_t v = strand.vertex + first; v < strand.vertex + end; ++v)
        for (float& mass : masses[v]) mass *= drag_shares_.of_samples[strand.sample + p];
    }
  drag_edge_masses_ = gl::Buffer(std::span<const std::array<float, 2>>(masses));
  drag_sums_ = zeros<int32_t>(4 * nodes_count_);
  drag_nodes_ = zeros<Vec4>(nodes_count_);
  drag_densities_ = zeros<float>(nodes_count_);
}

void HairPasses::computeRestDensity(const StrandModel& model, AirBlock& block) {
  std::vector<Vec4> rest(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      const Vec3 x = model.restPosition(s, v);
      rest[v] = {x.x(), x.y(), x.z(), 0};
    }
  const gl::Buffer positions{std::span<const Vec4>(rest)}, velocities = zeros<Vec4>(rest.size());
  describe(block.settings, Pose{}, Parameters(), 1);
  block.send();
  splat({positions, velocities}, false);
  finishPass();
  computeDensity(false);
  finishPass();
  bindTiles({positions, velocities});
  resting_.bindStorage(0);
  held_.bindStorage(1);
  crowd_sums_.bindStorage(8);
  densities_.bindStorage(11);
  rest_of_.get(programs_, "hair_crowd.comp", shaders::kHairCrowdComp, "#define MEASURE 1\n").use();
  dispatchTiles();
  finishPass();
  reset();
}

void HairPasses::setVolumeTarget(float volume_target) {
  if (bound_target_ == volume_target) return;
  std::vector<std::array<float, 2>> resting(tiles_ * kTileSamples);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(resting_.id(), 0, static_cast<GLsizeiptr>(resting_.bytes()), resting.data());
  const double alone = kDensityAlone / std::pow(static_cast<double>(layout_.cell), 3);
  bound_target_ = volume_target;
  crowding_bound_ = 0;
  for (const auto& [mass, rest] : resting) {
    if (!(mass > 0)) continue;  // padding of a tile
    const double m = static_cast<double>(mass),
                 r = static_cast<double>(rest) / static_cast<double>(volume_target);
    crowding_bound_ += m * kernels::f64::largestCrowding(r, alone * m) * (1 + kMaxHeldCrowding);
  }
}

void HairPasses::describe(AirSettings& s, const Pose& head, const Parameters& p, double seconds) {
  float frame[12];
  layout_.frame(head, frame);
  const Eigen::Matrix3f turn = Eigen::Quaternionf(head.rotation).toRotationMatrix();
  for (size_t r = 0; r < 3; ++r) {
    s.hair_frame[r] = {frame[3 * r], frame[3 * r + 1], frame[3 * r + 2], frame[9 + r]};
    const auto row = static_cast<Eigen::Index>(r);
    s.turn[r] = {turn(row, 0), turn(row, 1), turn(row, 2), 0};
  }
  const double cell = static_cast<double>(layout_.cell);
  const double stiffness =
      std::min(static_cast<double>(p.volume_stiffness), layout_.largestStiffness(seconds));
  s.cells = layout_.cells;
  s.tiles = static_cast<uint32_t>(tiles_);
  s.seconds = static_cast<float>(seconds);
  s.mass = static_cast<float>(mass_);
  s.mass_scale = static_cast<float>(kWhole / mass_);
  s.per_volume = static_cast<float>(1 / (cell * cell * cell));
  s.stiffness = static_cast<float>(stiffness);
  s.gain = static_cast<float>(static_cast<double>(p.volume_hold) * seconds);
  s.rest_scale = static_cast<float>((1 + kDensityNoise) / static_cast<double>(p.volume_target));
  s.crowd_scale = stiffness > 0 ? static_cast<float>(kWhole / (stiffness * crowding_bound_)) : 0.0f;
  s.slope = static_cast<float>(-seconds / (2 * cell));
  s.friction = static_cast<float>(1 - std::exp(-static_cast<double>(p.hair_friction) * seconds));
  s.alone = static_cast<float>(kDensityAlone / (cell * cell * cell));
}

void HairPasses::reset() {
  glClearNamedBufferData(held_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  measured_ = false;
}

void HairPasses::setRates(std::span<const float> rates) {
  rated_ = !rates.empty();
  if (rated_) rates_ = gl::Buffer(rates);
}

void HairPasses::dispatchTiles() const {
  const auto groups = static_cast<GLuint>(tiles_), wide = std::min(groups, kWide);
  glDispatchCompute(wide, (groups + wide - 1) / wide, 1);
}
void HairPasses::dispatchNodes() const {
  const auto tiles = static_cast<GLuint>(layout_.cells / kTile);
  glDispatchCompute(tiles, tiles, tiles);
}

void HairPasses::bindTiles(const Strands& strands) const {
  strands.positions.bindStorage(0);
  strands.velocities.bindStorage(1);
  sample_tiles_.bindStorage(2);
  roots_.bindStorage(3);
  edge_masses_.bindStorage(4);
  places_.bindStorage(5);
  fastest_.bindStorage(6);
  motions_.bindStorage(9);
  order_.bindStorage(10);
}

void HairPasses::splat(const Strands& strands, bool drags) {
  bindTiles(strands);
  sums_.bindStorage(7);
  if (!clean_) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glClearNamedBufferData(sums_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  }
  if (!measured_) {
    glClearNamedBufferData(fastest_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    fastest_of_.get(programs_, "hair_splat.comp", shaders::kHairSplatComp, "#define MEASURE 1\n").use();
    dispatchTiles();
    finishPass();
    measured_ = true;
  }
  splat_.get(programs_, "hair_splat.comp", shaders::kHairSplatComp, "#define MEASURE 0\n").use();
  if (drags && unevenlyDragged()) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glClearNamedBufferData(drag_sums_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    drag_edge_masses_.bindStorage(4);
    drag_sums_.bindStorage(7);
    dispatchTiles();
    finishPass();  // both dispatches write places_ and motions_
    edge_masses_.bindStorage(4);
    sums_.bindStorage(7);
  }
  dispatchTiles();
  clean_ = false;
}

void HairPasses::reserveSlip() {
  if (slip_sums_.bytes() == 0) slip_sums_ = zeros<int32_t>(8 * nodes_count_);
}

void HairPasses::splatSlip(const Strands& strands) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glClearNamedBufferData(slip_sums_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  bindTiles(strands);
  if (unevenlyDragged()) drag_edge_masses_.bindStorage(4);
  slip_sums_.bindStorage(7);
  slip_of_.get(programs_, "hair_slip.comp", shaders::kHairSlipComp).use();
  dispatchTiles();
}

void HairPasses::computeDensity(bool drags) {
  density_of_.get(programs_, "hair_density.comp", shaders::kHairDensityComp).use();
  fastest_.bindStorage(6);
  crowd_sums_.bindStorage(8);
  auto find = [&](const gl::Buffer& sums, const gl::Buffer& nodes, const gl::Buffer& densities) {
    sums.bindStorage(7);
    nodes.bindStorage(9);
    densities.bindStorage(10);
    dispatchNodes();
  };
  if (drags && unevenlyDragged()) find(drag_sums_, drag_nodes_, drag_densities_);
  find(sums_, nodes_, densities_);
}

void HairPasses::crowd(const Strands& strands) {
  bindTiles(strands);
  resting_.bindStorage(0);
  held_.bindStorage(1);
  crowd_sums_.bindStorage(8);
  densities_.bindStorage(11);
  crowd_.get(programs_, "hair_crowd.comp", shaders::kHairCrowdComp, "#define MEASURE 0\n").use();
  dispatchTiles();
}

void HairPasses::computeForces(bool crowds, bool rubs) {
  sums_.bindStorage(7);
  crowd_sums_.bindStorage(8);
  nodes_.bindStorage(9);
  densities_.bindStorage(10);
  changes_.bindStorage(11);
  static constexpr const char* kDefines[] = {
      "#define CROWDS 0\n#define RUBS 0\n", "#define CROWDS 1\n#define RUBS 0\n",
      "#define CROWDS 0\n#define RUBS 1\n", "#define CROWDS 1\n#define RUBS 1\n"};
  const size_t which = (crowds ? 1u : 0u) + (rubs ? 2u : 0u);
  forces_of_[which].get(programs_, "hair_forces.comp", shaders::kHairForcesComp, kDefines[which]).use();
  dispatchNodes();
  clean_ = true;
}

void HairPasses::gather(const Strands& strands, const Needs& needs, const gl::Buffer& centres,
                        const gl::Buffer& turbulence, const gl::Buffer& sources,
                        const gl::Buffer& accelerations) {
  bindTiles(strands);
  rates_.bindStorage(7);
  accelerations.bindStorage(8);
  changes_.bindStorage(11);
  centres.bindStorage(12);
  turbulence.bindStorage(13);
  sources.bindStorage(14);
  const auto air = static_cast<size_t>(needs.air);
  LazyProgram& lazy =
      gather_of_[air + 3 * ((needs.forces ? 1u : 0u) + (rated_ ? 2u : 0u) + (needs.along ? 4u : 0u))];
  char defines[80];
  const auto end =
      fmt::format_to_n(defines, sizeof defines - 1,
                       "#define FORCES {:d}\n#define AIR {}\n#define RATES {:d}\n#define ALONG {:d}\n",
                       needs.forces, air, rated_, needs.along);
  *end.out = '\0';
  lazy.get(programs_, "hair_gather.comp", shaders::kHairGatherComp, defines).use();
  dispatchTiles();
  finishPass();
}

std::vector<std::array<float, 4>> HairPasses::downloadNodes() const {
  std::vector<Vec4> out(nodes_count_);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(nodes_.id(), 0, static_cast<GLsizeiptr>(out.size() * sizeof(out[0])), out.data());
  return out;
}

}  // namespace strandcast::gpu
