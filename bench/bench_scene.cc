#include "bench/bench_scene.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "collision/field_bake.h"

namespace strandcast {

void addPrintOptions(CLI::App& app, PrintOptions& print) {
  app.add_flag("--json", print.json, "print one JSON object");
  app.add_flag("--csv", print.csv, "print comma-separated values");
}

void addScene(CLI::App& app, std::string& scene) {
  app.add_option("--scene", scene, "procedural scene")->capture_default_str();
}
void addSeed(CLI::App& app, uint64_t& seed) {
  app.add_option("--seed", seed, "seed of the scene's hair")->capture_default_str();
}
void addStrands(CLI::App& app, int& strands, const std::string& about) {
  app.add_option("--strands", strands, about)->check(CLI::Range(1, 1000000))->capture_default_str();
}
void addVertices(CLI::App& app, int& vertices, const std::string& about) {
  app.add_option("--vertices", vertices, about)->check(CLI::Range(2, 128))->capture_default_str();
}
void addSubsteps(CLI::App& app, int& substeps, const std::string& about) {
  app.add_option("--substeps", substeps, about)->check(CLI::Range(1, 64))->capture_default_str();
}
void addThreads(CLI::App& app, int& threads, const std::string& about) {
  app.add_option("--threads", threads, about)->check(CLI::Range(0, 1024))->capture_default_str();
}
void addSteps(CLI::App& app, int& steps, const std::string& about) {
  app.add_option("--steps", steps, about)->check(CLI::Range(1, 100000))->capture_default_str();
}
void addBackend(CLI::App& app, std::string& backend, const std::vector<std::string>& names,
                const std::string& about) {
  app.add_option("--backend", backend, about)->check(CLI::IsMember(names))->capture_default_str();
}

Scene benchScene(const std::string& name, int strands, int vertices, uint64_t seed) {
  SceneOptions make;
  make.name = name;
  make.strands = strands;
  make.vertices = vertices;
  make.seed = seed;
  return makeScene(make);
}

HeadMotion benchMotion(const Scene& scene, double hertz) {
  if (hertz <= 0) return scene.motion;
  // The scenes' own shake has a frequency of 1 Hz.
  return [shake = headMotion("shake", scene.head_pivot), hertz](double seconds) {
    return shake(hertz * seconds);
  };
}

std::vector<ContactPrimitive> fivePrimitives(const Vec3& pivot) {
  auto at = [&](float x, float y, float z) -> Vec3 { return pivot + Vec3(x, y, z); };
  ContactPrimitive sphere{PrimitiveKind::kSphere, at(0.09f, 0.06f, 0), Vec3::UnitY(), 0.025f};
  ContactPrimitive capsule{PrimitiveKind::kCapsule, at(-0.2f, -0.1f, 0), at(0.2f, -0.1f, 0), 0.05f};
  ContactPrimitive tapered{PrimitiveKind::kTaperedCapsule, at(0.12f, 0, -0.05f), at(0.12f, -0.2f, -0.05f),
                           0.03f};
  tapered.radius_b = 0.045f;
  ContactPrimitive ellipsoid{PrimitiveKind::kEllipsoid, at(-0.12f, -0.02f, -0.02f), Vec3::UnitY(), 0};
  ellipsoid.extent = Vec3(0.02f, 0.06f, 0.04f);
  ContactPrimitive box{PrimitiveKind::kBox, at(0, -0.1f, -0.14f), Vec3::UnitY(), 0};
  box.extent = Vec3(0.1f, 0.08f, 0.01f);
  return {sphere, capsule, tapered, ellipsoid, box};
}

Bake bakeField(const TriangleMesh& mesh, float cell, int threads, ContactPrimitive& field) {
  FieldOptions options;
  options.cell = cell;
  BakeLimits limits;
  limits.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  FieldBaker baker(mesh, options, limits);
  field.kind = PrimitiveKind::kField;
  field.field = std::make_shared<const DistanceField>(baker.bake());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const DistanceField& made = *field.field;
  return {mesh.name,
          mesh.triangles.size(),
          4 * (made.index.size() + made.samples.size() + made.corners.size()),
          baker.estimate().working_bytes,
          seconds,
          baker.options().cell};
}

void addAir(Parameters& parameters, int cells, bool mac_cormack) {
  parameters.wind = Vec3(3, 0, 1);
  parameters.wind_grid = 1;
  parameters.grid_cells = cells;
  parameters.volume_stiffness = 1;
  parameters.hair_friction = 5;
  parameters.mac_cormack = mac_cormack ? 1 : 0;
}

}  // namespace strandcast
