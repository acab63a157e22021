#pragma once
#include <string>
#include <vector>

#include "bench/measured_run.h"
#include "scenes/scene.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Declares --json and --csv.
void addPrintOptions(CLI::App& app, PrintOptions& print);

// Options shared by several verbs, each with one name, range and help. The present value is the default.
void addScene(CLI::App& app, std::string& scene);
void addSeed(CLI::App& app, uint64_t& seed);
void addStrands(CLI::App& app, int& strands, const std::string& about = "number of strands");
void addVertices(CLI::App& app, int& vertices, const std::string& about = "vertices per strand");
void addSubsteps(CLI::App& app, int& substeps, const std::string& about = "substeps per step");
void addThreads(CLI::App& app, int& threads,
                const std::string& about = "threads of the simd backend; 0 = all");
void addSteps(CLI::App& app, int& steps, const std::string& about = "timed steps, after a warm-up");
/// A backend; `names` lists those allowed.
void addBackend(CLI::App& app, std::string& backend, const std::vector<std::string>& names,
                const std::string& about = "backend that simulates");

/// A procedural scene with `strands` strands of `vertices` vertices. Throws Error.
Scene benchScene(const std::string& name, int strands, int vertices, uint64_t seed = 1);

/// A head shaken `hertz` times a second by 35 degrees to either side; 0: the scene's own motion.
HeadMotion benchMotion(const Scene& scene, double hertz);

/// The bodies in the hair of the contact benchmarks: shoulders, a comb, a hand, an ear. `pivot`: of the head,
/// m.
std::vector<ContactPrimitive> fivePrimitives(const Vec3& pivot);

/// Statistics of the bake of a body's distance field.
struct Bake {
  std::string mesh;
  size_t triangles = 0, field_bytes = 0, working_bytes = 0;
  double seconds = 0;
  float cell = 0;  ///< m
};
/// Bakes a mesh as a distance field into `field`. Throws Error.
Bake bakeField(const TriangleMesh& mesh, float cell, int threads, ContactPrimitive& field);

/// Enables all of air/ on grids of `cells` per axis: wind that hair and bodies block, and forces between
/// hairs.
void addAir(Parameters& parameters, int cells, bool mac_cormack = false);

}  // namespace strandcast
