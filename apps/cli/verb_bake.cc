#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "apps/cli/verbs.h"
#include "collision/field_bake.h"
#include "collision/field_cache.h"
#include "core/error.h"
#include "io/distance_field_file.h"
#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/output_folder.h"
#include "options/settings.h"
#ifdef STRANDCAST_HAS_RENDER
#include "service/slices.h"
#endif

namespace strandcast {
namespace {

constexpr size_t kMeasuredPoints = 10000;

struct BakeOptions {
  std::string file, out, up = "auto", cache, slices;
  float unit_meters = 0;
  FieldOptions field;
  BakeLimits limits;
  size_t memory_mib = 2048;
  bool no_cache = false, json = false;
};

double mebibytes(size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

void announce(const FieldBaker& baker, const std::string& file) {
  const BakeEstimate& e = baker.estimate();
  fmt::print(stderr,
             "{}: {} triangles, cells of {:.3g} mm: about {} bricks{}, {:.1f} MiB, and {:.1f} MiB while "
             "baking; about {:.1f} s; Ctrl-C stops it\n",
             file, baker.repair().triangles, 1e3 * baker.options().cell, e.bricks,
             baker.mesh().open_edges.empty() ? "" : " and more near lids of openings",
             mebibytes(e.field_bytes), mebibytes(e.working_bytes), e.seconds);
}

struct Baked {
  DistanceField field;
  bool from_cache = false;
  bool is_kept = false;  ///< is in the cache
  double seconds = 0;
};

Baked bakeOrFind(FieldBaker& baker, uint64_t key, const BakeOptions& o, ProgressBar& bar,
                 const BakeProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const FieldCache cache(o.no_cache        ? std::filesystem::path()
                         : o.cache.empty() ? defaultFieldCache()
                                           : std::filesystem::path(o.cache));
  std::string trouble;
  if (std::optional<DistanceField> found = cache.find(key, &trouble))
    return {std::move(*found), true, true, since()};
  bar.clear();
  if (!trouble.empty()) fmt::print(stderr, "warning: {}; the field is baked again\n", trouble);
  announce(baker, o.file);
  Baked baked{baker.bake(progress), false, false, since()};
  try {
    cache.keep(key, baked.field, baker.warnings());
    baked.is_kept = !o.no_cache;
  } catch (const Error& error) {
    fmt::print(stderr, "warning: {}\n", error.what());
  }
  return baked;
}

Report report(const BakeOptions& o, const Box& box, const FieldBaker& baker, const Baked& baked,
              const FieldAccuracy& a) {
  const DistanceField& field = baked.field;
  const FieldGrid& grid = field.grid;
  const double share = 100.0 / static_cast<double>(std::max<size_t>(a.points, 1));
  Report out;
  out.add("file", "field", o.out);
  const Eigen::Vector3f size = box.sizes();
  out.add("size", "size of the body",
          fmt::format("{:.3f} x {:.3f} x {:.3f} m", size.x(), size.y(), size.z()));
  out.addCount("triangles", "triangles", baker.repair().triangles);
  out.addCount("triangles_without_area", "  without area", baker.mesh().without_area);
  out.addCount("repeated_triangles", "  left out: duplicates", baker.repair().repeated);
  out.addCount("inner_triangles", "  left out: interior walls", baker.repair().inner);
  out.addCount("turned_triangles", "  turned: wound against their neighbours",
               baker.repair().turned_triangles);
  out.addCount("pieces", "pieces", baker.repair().pieces);
  out.addCount("turned_pieces", "  turned: pieces inside out", baker.repair().turned_pieces);
  out.addCount("hollow_pieces", "  taken as hollows inside others", baker.repair().hollows);
  out.addCount("hidden_triangles", "triangles with inside on both sides", baker.hiddenTriangles());
  out.addCount("open_edges", "open edges", baker.mesh().open_edges.size());
  out.add("doubtful_percent", "side in doubt", 100 * baker.uncertainShare(), "% of the surface", 2);
  out.add("unclear_percent", "side in doubt (winding number near 0.5)", share * a.unclear, "% of the band",
          2);
  out.add("cell_mm", "cell", 1e3 * grid.cell, "mm", 3);
  out.add("band_mm", "band", 1e3 * grid.band, "mm", 3);
  out.addCount("bricks", "bricks stored", field.storedBricks());
  out.addCount("grid_bricks", "bricks of the grid", field.bricks());
  out.add("mebibytes", "memory", mebibytes(field.bytes()), "MiB", 2);
  out.add("seconds", baked.from_cache ? "time (found in the cache)" : "time", baked.seconds, "s", 2);
  out.addCount("from_cache", "from the cache", baked.from_cache ? 1 : 0);
  out.addCount("points", "points compared with exact distances", a.points);
  out.add("error_worst_mm", "  distance, worst error", 1e3 * a.worst, "mm", 4);
  out.add("error_rms_mm", "  distance, rms error", 1e3 * a.rms, "mm", 4);
  out.add("angle_median_degrees", "  gradient, median angle", a.median_angle, "degrees", 3);
  out.add("angle_p99_degrees", "  gradient, 99 % below", a.p99_angle, "degrees", 2);
  out.add("angle_worst_degrees", "  gradient, worst angle", a.worst_angle, "degrees", 1);
  out.addCount("wrong_side", "  on the wrong side", a.wrong_side);
  return out;
}

int bake(BakeOptions o) {
  GroomReadOptions read;
  read.unit_meters = o.unit_meters;
  read.up = upAxisOf(o.up);
  o.limits.memory_bytes = o.memory_mib << 20;
  if (o.out.empty()) o.out = std::filesystem::path(o.file).stem().string() + ".sdf";
  checkWritable(o.out);
  std::optional<OutputFolder> slices;
  if (!o.slices.empty()) slices.emplace(o.slices);
  const ReadMesh body = loadMesh(o.file, read);
  if (!body.report.left_out.empty())
    fmt::print(stderr, "note: {}: read {}\n", o.file, body.report.omissionsLine());
  for (const std::string& warning : body.report.warnings)
    fmt::print(stderr, "warning: {}: {}\n", o.file, warning);
  const TriangleMesh& mesh = body.mesh;
  try {
    ProgressBar bar;
    const BakeProgress progress = [&](const std::string& what, double part) {
      bar.show(what, part);
      return !g_interrupted.load();
    };
    FieldBaker baker(mesh, o.field, o.limits, progress);
    const uint64_t key = fieldKey(mesh, baker.options());
    const Baked baked = bakeOrFind(baker, key, o, bar, progress);
    std::optional<FieldAccuracy> accuracy;
    try {
      accuracy = baker.measure(baked.field, kMeasuredPoints, progress);
    } catch (const BakeStopped&) {
      bar.clear();
      fmt::print(stderr, "interrupted before the field was measured: {} was not written{}\n", o.out,
                 baked.is_kept ? "; the field is in the cache, where the next bake finds it" : "");
      return kExitInterrupted;
    }
    bar.clear();
    writeDistanceField(o.out, baked.field, key);
#ifdef STRANDCAST_HAS_RENDER
    if (!o.slices.empty()) writeFieldSlices(baked.field, o.slices);
#endif
    for (const std::string& warning : baker.warnings())
      fmt::print(stderr, "warning: {}: {}\n", o.file, warning);
    if (!baked.field.hasInside()) fmt::print(stderr, "warning: {}: {}\n", o.file, kNoInside);
    report(o, mesh.bounds(), baker, baked, *accuracy).print(o.json);
  } catch (const BakeStopped&) {
    fmt::print(stderr, "interrupted; nothing was written\n");
    return kExitInterrupted;
  }
  return 0;
}

}  // namespace

Verb addBake(CLI::App& app) {
  const auto o = std::make_shared<BakeOptions>();
  app.footer(
      "The mesh may be open, intersect itself or have parts inside one another. Wrongly wound and duplicate\n"
      "triangles are repaired, and a warning says how many. The verb prints the expected time and memory "
      "before\n"
      "the bake, and the error of the field against the exact distance after it.\n"
      "Default cell: sqrt(diagonal of the body x hair radius / 8): on a sphere with a radius of 1/8 of the "
      "diagonal\n"
      "the field errs by a quarter of the hair's radius. Default band: four cells and the hair's radius.\n"
      "Example: strandcast bake head.obj --unit-meters 0.01 --cell 0.002 --slices slices");
  app.add_option("FILE", o->file, "body mesh: .obj, .gltf or .glb")->required();
  app.add_option("--out", o->out, "field to write; default: FILE's name with .sdf in the current folder");
  app.add_option("--cell", o->field.cell, "edge of a cell, m")->check(finiteRange(1e-6, 1e3));
  app.add_option("--band", o->field.band,
                 "distance from the surface up to which the field is stored at full resolution, m")
      ->check(finiteRange(2e-6, 1e6));
  app.add_option("--hair-radius", o->field.hair_radius,
                 "hair radius, m, from which the default cell and band follow")
      ->check(finiteRange(1e-6, 5e-3))
      ->capture_default_str();
  app.add_option("--unit-meters", o->unit_meters,
                 "metres per unit of FILE; default: 1 for glTF, guessed for .obj")
      ->check(finiteRange(1e-6, 1000.0));
  app.add_option("--up", o->up, "up axis of FILE; default: y")->check(CLI::IsMember({"auto", "x", "y", "z"}));
  app.add_option("--threads", o->limits.threads, "threads; 0 = all; the field does not depend on it")
      ->transform(wholeRange(0, 1024));
  app.add_option("--memory", o->memory_mib, "memory limit, MiB; a bake that needs more is refused")
      ->transform(wholeRange(1, 1 << 24))
      ->capture_default_str();
  auto* cache =
      app.add_option("--cache", o->cache, "folder of cached fields; default: XDG_CACHE_HOME/strandcast");
  app.add_flag("--no-cache", o->no_cache, "neither read nor write the cache")->excludes(cache);
#ifdef STRANDCAST_HAS_RENDER
  app.add_option("--slices", o->slices, "folder for pictures of slices through the field")
      ->check([](const std::string& folder) { return folder.empty() ? "name a folder" : std::string(); }, "");
#endif
  app.add_flag("--json", o->json, "print one JSON object");
  return [o] { return bake(*o); };
}

}  // namespace strandcast
