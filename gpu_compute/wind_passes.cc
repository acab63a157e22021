#include "gpu_compute/wind_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "gpu_compute/shaders.h"
#include "gpu_compute/step_input.h"

namespace strandcast::gpu {
namespace {

constexpr size_t kInvocations = 256;
constexpr int kAhead = 1;   // pressure iterations beyond those of the step before last
constexpr int kFirst = 12;  // pressure iterations of the first two steps
constexpr int kBatch = 4;   // pressure iterations between two reads of the residual by project()

/// Source of shaders/ambient.glsl.
struct PackedSource {
  float position[3], kind;
  float direction[3], rate;
  float radius, length, cosine, speed;
  float swirl, per_share, unused[2];
};
static_assert(sizeof(PackedSource) == 64);

PackedSource packedSource(const WindSource& source, double per_share) {
  const Vec3 p = source.position, d = source.direction.normalized();
  return {{p.x(), p.y(), p.z()},
          static_cast<float>(source.kind),
          {d.x(), d.y(), d.z()},
          source.rate,
          source.radius,
          source.length,
          std::cos(source.angle),
          source.speed,
          source.swirl,
          static_cast<float>(per_share),
          {}};
}
gl::Buffer bufferOf(std::span<const PackedSource> packed) {
  return packed.empty() ? zeros<PackedSource>(1) : gl::Buffer(packed);
}

size_t cubed(int n) { return static_cast<size_t>(n) * static_cast<size_t>(n) * static_cast<size_t>(n); }
float tolerance(const PressurePasses::State& state) {
  return static_cast<float>(
      std::max(kResidual * static_cast<double>(std::bit_cast<float>(state.fastest)), kStill));
}

}  // namespace

WindPasses::WindPasses(int cells, float cell, Wind::Border border, ProgramCache& programs)
    : programs_(programs),
      cells_(cells),
      cell_(cell),
      box_(cells, cell),
      border_(border),
      sources_(zeros<PackedSource>(1)),
      bodies_(zeros<PlacedBody>(1)),
      body_settings_(zeros<Settings>(2)),
      bodies_room_(1),
      pressure_(cells, border, programs) {
  for (gl::Buffer& faces : faces_) faces = zeros<float>(3 * cubed(cells + 1));
  for (gl::Buffer& pressures : pressures_) pressures = zeros<float>(cubed(cells));
  for (gl::Buffer* of_cells : {&centres_, &displacements_, &onwards_, &solids_, &exchange_})
    *of_cells = zeros<std::array<float, 4>>(cubed(cells));
  Settings settings{};
  settings.substeps = 1;
  settings.substep = settings.per_substep = 1;
  body_settings_.write(std::span<const Settings>(&settings, 1));
}

void WindPasses::describe(AirSettings& s, double seconds) const {
  const Vec3 low = origin(), mean = ambient_.mean(), carried = ambient_.carried();
  s.wind_box = {low.x(), low.y(), low.z(), cell_};
  s.ambient_mean = {mean.x(), mean.y(), mean.z(), ambient_.turbulence()};
  s.ambient_carried = {carried.x(), carried.y(), carried.z(), ambient_.boxPlacesPerMetre()};
  s.cells = cells_;
  s.open_border = border_ == Wind::Border::kOpen ? 1 : 0;
  s.seconds = static_cast<float>(seconds);
  s.courant = static_cast<float>(seconds / static_cast<double>(cell_));
  s.sources = static_cast<int>(on_grid_.size());
  s.spheres = spheres_ ? 1 : 0;
}

bool WindPasses::moveTo(const Vec3& middle, AirSettings& s) {
  const Eigen::Vector3i shift = box_.centreAt(middle);
  if (shift.isZero()) return false;
  for (int c = 0; c < 3; ++c) s.shift[c] = shift[c];
  return true;
}

void WindPasses::dispatchFaces() const {
  glDispatchCompute(groupsOf(3 * cubed(cells_ + 1), kInvocations), 1, 1);
}
void WindPasses::dispatchCells() const { glDispatchCompute(groupsOf(cubed(cells_), kInvocations), 1, 1); }

void WindPasses::bindAmbient() {
  if (turbulence_seed_ != ambient_.seed()) {
    turbulence_ = gl::Buffer(ambient_.box());
    turbulence_seed_ = ambient_.seed();
  }
  turbulence_.bindStorage(13);
  bindSources();
}

void WindPasses::bindSources() {
  if (!packed_) {
    std::vector<PackedSource> packed;
    for (const WindSource& source : on_grid_)
      packed.push_back(packedSource(source, source.kind == WindSource::Kind::kSphere
                                                ? SphereOnGrid(source, origin(), cell_).perShare()
                                                : 0));
    sources_ = bufferOf(packed);
    packed_ = true;
  }
  sources_.bindStorage(14);
}

void WindPasses::setSources(std::vector<WindSource> sources) {
  on_grid_ = std::move(sources);
  for (WindSource& source : on_grid_) source = onGrid(source, cell_);
  spheres_ = border_ == Wind::Border::kOpen &&
             std::any_of(on_grid_.begin(), on_grid_.end(),
                         [](const WindSource& source) { return source.kind == WindSource::Kind::kSphere; });
  packed_ = false;
}

std::vector<SphereOnGrid> WindPasses::spheres() const {
  std::vector<SphereOnGrid> spheres;
  for (const WindSource& source : on_grid_)
    if (spheres_ && source.kind == WindSource::Kind::kSphere) spheres.emplace_back(source, origin(), cell_);
  return spheres;
}

void WindPasses::carry() {
  bindAmbient();
  faces().bindStorage(0);
  next().bindStorage(1);
  pressures_[0].bindStorage(3);
  pressures_[1].bindStorage(4);
  carry_.get(programs_, "wind_shift.comp", shaders::kWindShiftComp, "#define CENTRES 0\n").use();
  dispatchFaces();
  finishPass();
  advance();
  std::swap(pressures_[0], pressures_[1]);
  faces().bindStorage(0);
  centres_.bindStorage(2);
  centres_of_.get(programs_, "wind_shift.comp", shaders::kWindShiftComp, "#define CENTRES 1\n").use();
  dispatchCells();
  finishPass();
}

void WindPasses::reset(AirBlock& block) {
  describe(block.settings, 1);
  for (int& shift : block.settings.shift) shift = 2 * cells_;  // farther than the grid: every value is new
  block.send();
  carry();
}

void WindPasses::setFaces(std::span<const float> values) {
  faces().write(values);
  faces().bindStorage(0);
  centres_.bindStorage(2);
  centres_of_.get(programs_, "wind_shift.comp", shaders::kWindShiftComp, "#define CENTRES 1\n").use();
  dispatchCells();
  finishPass();
}

void WindPasses::setBodies(std::span<const MovingPrimitive> bodies, AirSettings& s) {
  s.bodies = static_cast<int>(bodies.size());
  if (bodies.empty()) return;
  if (bodies.size() > bodies_room_) {
    bodies_room_ = 2 * bodies.size();
    bodies_ = zeros<PlacedBody>(bodies_room_);
  }
  bends_ = std::any_of(bodies.begin(), bodies.end(), isBent);
  placed_.clear();
  for (const MovingPrimitive& body : bodies) placed_.push_back(placedBody(body, 1, 1, 1, 0));
  bodies_.write(std::span<const PlacedBody>(placed_));
}

gl::Buffer WindPasses::packed(std::span<const WindSource> sources) {
  std::vector<PackedSource> packed;
  for (const WindSource& source : sources) packed.push_back(packedSource(source, 0));
  return bufferOf(packed);
}

void WindPasses::computeDisplacements(bool mac_cormack) {
  centres_.bindStorage(2);
  displacements_.bindStorage(3);
  onwards_.bindStorage(4);
  (mac_cormack ? displace_both_ : displace_)
      .get(programs_, "wind_displace.comp", shaders::kWindDisplaceComp,
           mac_cormack ? "#define ONWARD 1\n" : "#define ONWARD 0\n")
      .use();
  dispatchCells();
}

void WindPasses::advect(bool mac_cormack) {
  bindAmbient();
  faces().bindStorage(0);
  next().bindStorage(1);
  displacements_.bindStorage(3);
  advect_.get(programs_, "wind_advect.comp", shaders::kWindAdvectComp, "#define CORRECT 0\n").use();
  dispatchFaces();
  finishPass();
  if (mac_cormack) {
    next().bindStorage(5);
    next(2).bindStorage(1);
    onwards_.bindStorage(4);
    correct_.get(programs_, "wind_advect.comp", shaders::kWindAdvectComp, "#define CORRECT 1\n").use();
    dispatchFaces();
    finishPass();
  }
  advance(mac_cormack ? 2 : 1);
}

void WindPasses::computeSolids(const gl::Buffer& shapes) {
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, body_settings_.id());
  solids_.bindStorage(0);
  bodies_.bindStorage(7);
  shapes.bindStorage(14);
  (bends_ ? bent_solids_of_ : solids_of_)
      .get(programs_, "wind_solids.comp", shaders::kWindSolidsComp,
           bends_ ? "#define SHAPE_KINDS 2\n" : "#define SHAPE_KINDS 1\n")
      .use();
  dispatchCells();
}

void WindPasses::reserveSlip() {
  if (slip_.bytes() == 0) slip_ = zeros<std::array<float, 8>>(cubed(cells_));
}

void WindPasses::computeExchange(const std::optional<HairOnAir>& hair) {
  const bool slips = hair && hair->slip_sums != nullptr;
  bindSources();
  exchange_.bindStorage(5);
  if (hair) hair->nodes.bindStorage(9);
  if (slips) {
    hair->fastest->bindStorage(6);
    hair->slip_sums->bindStorage(7);
    slip_.bindStorage(10);
  }
  (slips  ? exchange_slip_
   : hair ? exchange_hair_
          : exchange_of_)
      .get(programs_, "wind_exchange.comp", shaders::kWindExchangeComp,
           slips  ? "#define HAIR 2\n"
           : hair ? "#define HAIR 1\n"
                  : "#define HAIR 0\n")
      .use();
  dispatchCells();
}

void WindPasses::diffuse(double seconds, double viscosity, bool exchanges) {
  const double whole = viscosity * seconds / (static_cast<double>(cell_) * static_cast<double>(cell_));
  const int steps = std::max(static_cast<int>(std::ceil(whole / kLargestPart)), exchanges ? 1 : 0);
  for (int step = 0; step < steps; ++step) {
    const bool last = exchanges && step + 1 == steps;
    const gl::Program& program = (last ? diffuse_exchange_ : diffuse_)
                                     .get(programs_, "wind_diffuse.comp", shaders::kWindDiffuseComp,
                                          last ? "#define EXCHANGE 1\n" : "#define EXCHANGE 0\n");
    glProgramUniform1f(program.id(), 0, static_cast<float>(whole / steps));
    faces().bindStorage(0);
    next().bindStorage(1);
    exchange_.bindStorage(5);
    program.use();
    dispatchFaces();
    finishPass();
    advance();
  }
}

void WindPasses::exchangeSlipping() {
  faces().bindStorage(0);
  next().bindStorage(1);
  exchange_.bindStorage(5);
  slip_.bindStorage(10);
  slip_of_.get(programs_, "wind_slip.comp", shaders::kWindSlipComp).use();
  dispatchFaces();
  finishPass();
  advance();
}

void WindPasses::closeFaces() {
  pressure_.begin();
  faces().bindStorage(0);
  next().bindStorage(1);
  solids_.bindStorage(2);
  pressure_.masks().bindStorage(3);
  pressure_.rights().bindStorage(4);
  pressure_.state().bindStorage(15);
  if (spheres_) bindSources();
  (spheres_ ? close_spheres_ : close_)
      .get(programs_, "wind_faces.comp", shaders::kWindFacesComp,
           spheres_ ? "#define SPHERES 1\n" : "#define SPHERES 0\n")
      .use();
  dispatchCells();
  finishPass();
  advance();
}

void WindPasses::subtractGradient() {
  faces().bindStorage(0);
  next().bindStorage(1);
  centres_.bindStorage(2);
  pressure_.masks().bindStorage(3);
  pressures_[0].bindStorage(4);
  subtract_.get(programs_, "wind_gradient.comp", shaders::kWindGradientComp).use();
  dispatchCells();
  finishPass();
  advance();
}

PressureReport WindPasses::project() {
  closeFaces();
  PressureReport report;
  float fastest = 0;
  do {
    pressure_.solve(kBatch, pressures_[0]);
    const PressurePasses::State state = pressure_.download();
    fastest = tolerance(state);
    report = PressurePasses::reportOf(state);
  } while (report.residual > static_cast<double>(fastest) && report.iterations < kMaxPressureIterations);
  subtractGradient();
  return report;
}

WindPasses::Reports::Reports() {
  constexpr GLbitfield kRead = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  for (size_t i = 0; i < kSlots; ++i) {
    buffers[i] = gl::Buffer(sizeof(PressurePasses::State), nullptr, kRead | GL_CLIENT_STORAGE_BIT);
    memory[i] = static_cast<const PressurePasses::State*>(
        glMapNamedBufferRange(buffers[i].id(), 0, sizeof(PressurePasses::State), kRead));
    if (memory[i] == nullptr)
      throw Error("the GPU has no memory to share with the CPU", "wind", "use --backend simd");
  }
}

void WindPasses::projectAhead(gl::PassTimer& timer) {
  Reports& r = reports_;
  const auto slot = static_cast<size_t>(r.step % kSlots);
  int iterations = kFirst;
  if (r.step >= 2) {
    const auto last = static_cast<size_t>((r.step - 2) % kSlots);
    r.fences[last].wait();
    iterations = std::min(r.memory[last]->iterations + kAhead, kMaxPressureIterations);
  }
  closeFaces();
  timer.passed("close faces");
  pressure_.solve(iterations, pressures_[0]);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glCopyNamedBufferSubData(pressure_.state().id(), r.buffers[slot].id(), 0, 0, sizeof(PressurePasses::State));
  r.fences[slot].set();
  ++r.step;
  timer.passed("pressure");
  subtractGradient();
  timer.passed("subtract gradient");
}

PressureReport WindPasses::newestPressure() const {
  const PressurePasses::State state = pressure_.download();
  PressureReport report = PressurePasses::reportOf(state);
  report.residual /= std::max(1e-30, static_cast<double>(std::bit_cast<float>(state.fastest)));
  return report;
}

WindPasses::Image WindPasses::download() const {
  Image image;
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  auto read = [&](const gl::Buffer& from, auto& to, size_t count) {
    to.resize(count);
    glGetNamedBufferSubData(from.id(), 0, static_cast<GLsizeiptr>(count * sizeof(to[0])), to.data());
  };
  read(faces_[now_], image.faces, 3 * cubed(cells_ + 1));
  read(pressures_[0], image.pressures, cubed(cells_));
  read(centres_, image.centres, cubed(cells_));
  read(pressure_.masks(), image.masks, cubed(cells_));
  return image;
}

}  // namespace strandcast::gpu
