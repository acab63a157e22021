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
  // The scenes' own shakes once a second.
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
