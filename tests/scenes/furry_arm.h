#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "collision/tree_broad_phase.h"
#include "io/file_bytes.h"
#include "scenes/scene.h"
#include "simd/simd_backend.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"

namespace strandcast {

inline void writeStrands(const std::filesystem::path& file, const std::vector<std::vector<Vec3>>& strands) {
  std::ofstream out(file);
  size_t first = 1;
  for (const std::vector<Vec3>& strand : strands) {
    for (const Vec3& p : strand) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    out << 'l';
    for (size_t i = 0; i < strand.size(); ++i) out << ' ' << first + i;
    out << '\n';
    first += strand.size();
  }
}

/// Hair on an arm. Writes the arm into `folder`; the caller writes hair.obj. The arm's clip bends it by 60
/// degrees within a second; hair grows on the upper joint. The fields are baked once for all tests.
inline SceneOptions bendingArm(const ScratchFolder& folder, UpAxis up) {
  static const ScratchFolder baked;
  writeFileBytes(folder / "arm.glb", samples::armGlb());
  SceneOptions options;
  options.groom = {folder / "hair.obj"};
  options.body = folder / "arm.glb";
  options.units = {1, up};
  options.body_units.up = up;
  options.skinned = SkinnedMotion{"bend", "upper"};
  options.body_cell = 0.005f;
  options.field_cache = baked / "fields";
  return options;
}

/// A simulation of a scene with the rod solver.
inline Simulation simulated(const Scene& scene, std::unique_ptr<Backend> backend = makeSimdBackend()) {
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  return Simulation(sceneModel(scene), scene.bodies, parameters, std::move(backend), nullptr,
                    makeTreeBroadPhase());
}

/// Steps a simulation, with clip and motion at the time of the step's end.
inline void stepWith(const Scene& scene, Simulation& simulation) {
  const double end = simulation.time() + static_cast<double>(simulation.parameters().time_step);
  moveTo(scene.skinned.get(), end, scene.motion(end), simulation);
  simulation.step();
}

/// `count` strands of `length` (m) that stand out on all sides of an arm along Y (samples::ArmOptions),
/// between `from` and `to` (m) along it. Their roots are on a cylinder of `radius` (m).
inline std::vector<std::vector<Vec3>> fur(int count, float from, float to, float radius, float length,
                                          int vertices = 8) {
  std::vector<std::vector<Vec3>> strands;
  for (int s = 0; s < count; ++s) {
    const float turn = 2.399963f * static_cast<float>(s);  // the golden angle
    const float y = from + (to - from) * (static_cast<float>(s) + 0.5f) / static_cast<float>(count);
    std::vector<Vec3>& strand = strands.emplace_back();
    for (int i = 0; i < vertices; ++i) {
      const float out = radius + length * static_cast<float>(i) / static_cast<float>(vertices - 1);
      strand.emplace_back(out * std::cos(turn), y, -out * std::sin(turn));
    }
  }
  return strands;
}

}  // namespace strandcast
