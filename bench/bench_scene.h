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

// Options that several verbs have, each with one name, range and help. What is in them is the default.
void addScene(CLI::App& app, std::string& scene);
void addSeed(CLI::App& app, uint64_t& seed);
void addStrands(CLI::App& app, int& strands, const std::string& about = "of hair");
void addVertices(CLI::App& app, int& vertices, const std::string& about = "per strand");
void addSubsteps(CLI::App& app, int& substeps, const std::string& about = "per step");
void addThreads(CLI::App& app, int& threads, const std::string& about = "of the simd backend; 0 = all");
void addSteps(CLI::App& app, int& steps, const std::string& about = "timed, after a warm-up");
/// A backend, of which those of `names` are allowed.
void addBackend(CLI::App& app, std::string& backend, const std::vector<std::string>& names,
                const std::string& about = "what simulates");

/// One of the procedural scenes with so many strands of so many vertices. Throws Error.
Scene benchScene(const std::string& name, int strands, int vertices, uint64_t seed = 1);

/// A head that is shaken `hertz` times a second by 35 degrees to either side; 0: the scene's own motion.
HeadMotion benchMotion(const Scene& scene, double hertz);

/// What benchmarks of contact have in the hair: shoulders, a comb, a hand, an ear. `pivot`: of the head, m.
std::vector<ContactPrimitive> fivePrimitives(const Vec3& pivot);

/// How a body's distance field was baked.
struct Bake {
  std::string mesh;
  size_t triangles = 0, field_bytes = 0, working_bytes = 0;
  double seconds = 0;
  float cell = 0;  ///< m
};
/// A mesh as its field, into `field`. Throws Error.
Bake bakeField(const TriangleMesh& mesh, float cell, int threads, ContactPrimitive& field);

/// Everything that air/ does, on grids of `cells` per axis: wind that hair and bodies block, forces between
/// hairs.
void addAir(Parameters& parameters, int cells, bool mac_cormack = false);

}  // namespace strandcast
