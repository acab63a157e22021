#include "gpu_compute/pressure_passes.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

constexpr int kLines = 32;        // lines per workgroup of shaders/pressure_step.comp: LINES
constexpr int kBundleZ = 4;       // lines per workgroup of shaders/pressure_correct.comp along z: OWN_Z
constexpr int kBundleOf96 = 8;    // along y, up to 96 cells per axis: OWN_Y
constexpr int kBundleBeyond = 4;  // along y, beyond

size_t cellCount(int n) { return static_cast<size_t>(n) * static_cast<size_t>(n) * static_cast<size_t>(n); }
int bundleY(int cells) { return cells <= 96 ? kBundleOf96 : kBundleBeyond; }
GLuint bundles(int cells, int own) { return static_cast<GLuint>(cells / own); }

void setInt(const gl::Program& program, GLint location, int value) {
  glProgramUniform1i(program.id(), location, value);
}

/// Transform matrices and eigenvalues of the modes of a row of cells, as shaders/pressure_solve.glsl numbers
/// and folds them.
struct Modes {
  std::vector<float> matrices, eigenvalues;

  Modes(int cells, Wind::Border border) {
    const bool open = border == Wind::Border::kOpen;
    const int half = cells / 2;
    // mode(): value of mode `number` at the centre of cell `place`; modes are orthonormal. One cell beyond an
    // open border the value is 0; beyond a wall it is that of the last cell.
    auto angle = [&](int number) { return std::numbers::pi * (number + (open ? 1 : 0)) / (cells + open); };
    auto mode = [&](int number, int place) {
      if (open) return std::sqrt(2.0 / (cells + 1)) * std::sin(angle(number) * (place + 1));
      return std::sqrt((number == 0 ? 1.0 : 2.0) / cells) * std::cos(angle(number) * (place + 0.5));
    };
    for (const bool back : {false, true})
      for (int parity = 0; parity < 2; ++parity)
        for (int in = 0; in < half; ++in)
          for (int out = 0; out < half; ++out)
            matrices.push_back(
                static_cast<float>(back ? mode(2 * in + parity, out) : mode(2 * out + parity, in)));
    for (int parity = 0; parity < 2; ++parity)
      for (int n = 0; n < half; ++n)
        eigenvalues.push_back(static_cast<float>(2 - 2 * std::cos(angle(2 * n + parity))));
  }
};

}  // namespace

PressurePasses::PressurePasses(int cells, Wind::Border border, ProgramCache& programs)
    : cells_(cells),
      state_(zeros<State>(1)),
      masks_(zeros<uint32_t>(cellCount(cells))),
      products_(zeros<std::array<float, 2>>(bundles(cells, bundleY(cells)) * bundles(cells, kBundleZ))) {
  for (gl::Buffer* buffer :
       {&rights_, &residuals_, &steps_, &images_, &corrections_, &correction_images_, &modes_, &planes_})
    *buffer = zeros<float>(cellCount(cells));
  const Modes modes(cells, border);
  matrices_ = gl::Buffer(std::span<const float>(modes.matrices));
  eigenvalues_ = gl::Buffer(std::span<const float>(modes.eigenvalues));
  const std::string size = fmt::format("#define CELLS {}\n", cells);
  first_step_ = &programs.get("pressure_step.comp", shaders::kPressureStepComp, size + "#define FIRST 1\n");
  next_step_ = &programs.get("pressure_step.comp", shaders::kPressureStepComp, size + "#define FIRST 0\n");
  of_modes_ = &programs.get("pressure_modes.comp", shaders::kPressureModesComp, size);
  correct_ = &programs.get("pressure_correct.comp", shaders::kPressureCorrectComp, size);
}

void PressurePasses::begin() {
  glClearNamedBufferData(state_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  done_iterations_ = 0;
}

void PressurePasses::step(const gl::Program& program) const {
  program.use();
  glDispatchCompute(groupsOf(cellCount(cells_) / static_cast<size_t>(cells_), kLines), 1, 1);
  finishPass();
}

void PressurePasses::solve(int iterations, const gl::Buffer& pressure) {
  masks_.bindStorage(0);
  matrices_.bindStorage(1);
  rights_.bindStorage(2);
  pressure.bindStorage(3);
  residuals_.bindStorage(4);
  steps_.bindStorage(5);
  images_.bindStorage(6);
  corrections_.bindStorage(7);
  correction_images_.bindStorage(8);
  products_.bindStorage(9);
  modes_.bindStorage(10);
  eigenvalues_.bindStorage(11);
  planes_.bindStorage(12);
  state_.bindStorage(15);
  const GLuint along_y = bundles(cells_, bundleY(cells_)), along_z = bundles(cells_, kBundleZ);
  if (done_iterations_ == 0) step(*first_step_);
  for (int n = 0; n < iterations; ++n, ++done_iterations_) {
    of_modes_->use();
    glDispatchCompute(static_cast<GLuint>(cells_), 4, 1);
    finishPass();
    correct_->use();
    glDispatchCompute(along_y, along_z, 1);
    finishPass();
    setInt(*next_step_, 0, static_cast<int>(along_y * along_z));
    setInt(*next_step_, 1, done_iterations_ % 2);
    setInt(*next_step_, 2, done_iterations_ == 0 ? 1 : 0);
    step(*next_step_);
  }
}

PressurePasses::State PressurePasses::download() const {
  State state{};
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(state_.id(), 0, sizeof state, &state);
  return state;
}

// The residual after the last step is in residual_now until the next iteration moves it to residual.
PressureReport PressurePasses::reportOf(const State& state) {
  const float left = state.residual_now != 0 ? std::bit_cast<float>(state.residual_now) : state.residual;
  return {state.iterations, static_cast<double>(left)};
}

}  // namespace strandcast::gpu
