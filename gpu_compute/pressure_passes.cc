#include "gpu_compute/pressure_passes.h"

#include <algorithm>
#include <bit>

#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

constexpr int kTile = 8;     // cells per axis of a block
constexpr int kBottom = 16;  // cells per axis of the finest level that one workgroup does
constexpr int kInvocations = 256;

size_t cubed(int n) { return static_cast<size_t>(n) * static_cast<size_t>(n) * static_cast<size_t>(n); }
int tilesOf(int cells) { return (cells + kTile - 1) / kTile; }

void dispatchTiles(int cells) {
  const auto tiles = static_cast<GLuint>(tilesOf(cells));
  glDispatchCompute(tiles, tiles, tiles);
  finishPass();
}
void setInt(const gl::Program& program, GLint location, int value) {
  glProgramUniform1i(program.id(), location, value);
}

}  // namespace

PressurePasses::PressurePasses(int cells, ProgramCache& programs)
    : cells_(cells),
      state_(zeros<State>(1)),
      masks_(zeros<uint32_t>(cubed(cells))),
      rights_(zeros<float>(cubed(cells))) {
  int weights = 0;
  for (int n = cells;; n /= 2) {
    const bool finest = levels_.empty();
    levels_.push_back({n, finest ? 0 : weights, zeros<float>(finest ? 0 : cubed(n)), zeros<float>(cubed(n)),
                       zeros<float>(cubed(n))});
    if (!finest) weights += static_cast<int>(cubed(n + 1));
    if (n <= kCoarsest || n % 2 != 0) break;
  }
  tiled_ = 1;
  while (levels_[tiled_].cells > kBottom) ++tiled_;
  weights_ = zeros<std::array<float, 4>>(static_cast<size_t>(weights));
  for (gl::Buffer* buffer : {&images_, &residuals_[0], &residuals_[1], &steps_[0], &steps_[1]})
    *buffer = zeros<float>(cubed(cells));
  for (gl::Buffer* buffer : {&products_, &image_products_}) *buffer = zeros<float>(cubed(tilesOf(cells)));
  first_down_ =
      &programs.get("pressure_down.comp", shaders::kPressureDownComp, "#define FINE 1\n#define FIRST 1\n");
  next_down_ =
      &programs.get("pressure_down.comp", shaders::kPressureDownComp, "#define FINE 1\n#define FIRST 0\n");
  coarse_down_ =
      &programs.get("pressure_down.comp", shaders::kPressureDownComp, "#define FINE 0\n#define FIRST 0\n");
  fine_up_ = &programs.get("pressure_up.comp", shaders::kPressureUpComp, "#define FINE 1\n");
  coarse_up_ = &programs.get("pressure_up.comp", shaders::kPressureUpComp, "#define FINE 0\n");
  apply_ = &programs.get("pressure_apply.comp", shaders::kPressureApplyComp, "");
  bottom_ = &programs.get("pressure_bottom.comp", shaders::kPressureBottomComp, "");
  fine_coarsen_ = &programs.get("pressure_coarsen.comp", shaders::kPressureCoarsenComp, "#define FINE 1\n");
  coarse_coarsen_ = &programs.get("pressure_coarsen.comp", shaders::kPressureCoarsenComp, "#define FINE 0\n");
}

void PressurePasses::begin() {
  glClearNamedBufferData(state_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  done_iterations_ = 0;
}

void PressurePasses::coarsen() {
  masks_.bindStorage(0);
  weights_.bindStorage(1);
  weights_.bindStorage(2);
  for (size_t l = 0; l + 1 < levels_.size(); ++l) {
    const gl::Program& program = l == 0 ? *fine_coarsen_ : *coarse_coarsen_;
    setInt(program, 0, levels_[l].cells);
    setInt(program, 1, levels_[l].first_weight);
    setInt(program, 2, levels_[l + 1].first_weight);
    program.use();
    glDispatchCompute(groupsOf(cubed(levels_[l + 1].cells + 1), kInvocations), 1, 1);
    finishPass();
  }
}

void PressurePasses::down(size_t level) const {
  const Level& own = levels_[level];
  own.rights.bindStorage(2);
  own.smoothed.bindStorage(9);
  levels_[level + 1].rights.bindStorage(10);
  setInt(*coarse_down_, 0, own.cells);
  setInt(*coarse_down_, 1, own.first_weight);
  coarse_down_->use();
  dispatchTiles(own.cells);
}

void PressurePasses::bottom() const {
  const Level& own = levels_[tiled_];
  own.rights.bindStorage(2);
  own.results.bindStorage(11);
  setInt(*bottom_, 0, own.cells);
  setInt(*bottom_, 1, own.first_weight);
  setInt(*bottom_, 2, static_cast<int>(levels_.size() - tiled_));
  setInt(*bottom_, 3, kCoarsestSweeps);
  bottom_->use();
  glDispatchCompute(1, 1, 1);
  finishPass();
}

void PressurePasses::up(size_t level) const {
  const Level& own = levels_[level];
  const gl::Program& program = level == 0 ? *fine_up_ : *coarse_up_;
  own.smoothed.bindStorage(9);
  levels_[level + 1].results.bindStorage(10);
  own.results.bindStorage(11);
  setInt(program, 0, own.cells);
  if (level > 0) {
    own.rights.bindStorage(2);
    setInt(program, 1, own.first_weight);
  }
  program.use();
  dispatchTiles(own.cells);
}

void PressurePasses::solve(int iterations, const gl::Buffer& pressure) {
  const Level& finest = levels_[0];
  masks_.bindStorage(0);
  weights_.bindStorage(1);
  state_.bindStorage(15);
  auto fineDown = [&](int iteration) {
    const auto now = static_cast<size_t>(iteration % 2), before = 1 - now;
    const gl::Program& program = iteration == 0 ? *first_down_ : *next_down_;
    rights_.bindStorage(2);
    pressure.bindStorage(3);
    residuals_[before].bindStorage(4);
    residuals_[now].bindStorage(5);
    steps_[before].bindStorage(6);
    images_.bindStorage(7);
    image_products_.bindStorage(8);
    finest.smoothed.bindStorage(9);
    levels_[1].rights.bindStorage(10);
    setInt(program, 0, cells_);
    if (iteration > 0) setInt(program, 2, static_cast<int>(before));
    program.use();
    dispatchTiles(cells_);
  };
  if (done_iterations_ == 0) fineDown(0);
  for (int n = 0; n < iterations; ++n, ++done_iterations_) {
    const auto now = static_cast<size_t>(done_iterations_ % 2), before = 1 - now;
    for (size_t l = 1; l < tiled_; ++l) down(l);
    bottom();
    for (size_t l = tiled_ - 1; l > 0; --l) up(l);
    residuals_[now].bindStorage(2);
    products_.bindStorage(8);
    up(0);
    finest.results.bindStorage(2);
    products_.bindStorage(3);
    steps_[before].bindStorage(6);
    steps_[now].bindStorage(7);
    images_.bindStorage(9);
    image_products_.bindStorage(10);
    setInt(*apply_, 0, cells_);
    setInt(*apply_, 2, static_cast<int>(now));
    setInt(*apply_, 3, done_iterations_ == 0 ? 1 : 0);
    apply_->use();
    dispatchTiles(cells_);
    fineDown(done_iterations_ + 1);
  }
}

PressurePasses::State PressurePasses::download() const {
  State state{};
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(state_.id(), 0, sizeof state, &state);
  return state;
}

// What the last step along a direction left is known before another iteration has looked at it.
PressureReport PressurePasses::reportOf(const State& state) {
  const float left = state.residual_now != 0 ? std::bit_cast<float>(state.residual_now) : state.residual;
  return {state.iterations, static_cast<double>(left)};
}

}  // namespace strandcast::gpu
