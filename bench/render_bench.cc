#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>

#include "bench/bench_simulation.h"
#include "gl/context.h"
#include "render/framebuffer.h"
#include "render/renderer.h"
#include "render/shader_validation.h"
#include "validation/bound_hair_trial.h"

namespace strandcast {
namespace {

struct RenderOptions {
  std::vector<int> hairs{10000, 50000, 100000};
  int vertices = 64, guides = 2000, width = 1920, height = 1080, samples = 4, pictures = 20;
  std::string scene = "curly";
  uint64_t seed = 1;
  bool growth_only = false;
  std::vector<std::filesystem::path> bound;
  std::filesystem::path body;
  float unit_meters = 0;
  PrintOptions print;
};

/// Time of `work` by the device's clock, ms.
template <class Work>
Spread deviceMs(int times, const Work& work) {
  GLuint stamps[2];
  glCreateQueries(GL_TIMESTAMP, 2, stamps);
  std::vector<double> ms;
  for (int i = 0; i < times + 2; ++i) {
    glQueryCounter(stamps[0], GL_TIMESTAMP);
    work();
    glQueryCounter(stamps[1], GL_TIMESTAMP);
    GLuint64 begin = 0, end = 0;
    glGetQueryObjectui64v(stamps[0], GL_QUERY_RESULT, &begin);
    glGetQueryObjectui64v(stamps[1], GL_QUERY_RESULT, &end);
    if (i >= 2) ms.push_back(1e-6 * static_cast<double>(end - begin));
  }
  glDeleteQueries(2, stamps);
  return spreadOf(std::move(ms));
}

struct GrowthTimes {
  double distribute_ms;
  Spread nodes_ms, growth_ms;
  size_t bytes;  ///< of the grown vertices
  double error;  ///< of a sample of the vertices, relative to the length of their guides
};

GrowthTimes timeGrowth(const RenderOptions& o, const StrandSet& guides, const HairGrowth& growth) {
  const int segments = o.vertices - 1;
  GuideNodes nodes(segments);
  nodes.setGroom(guides);
  HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
  const auto start = std::chrono::steady_clock::now();
  std::vector<Hair> hairs = growHairs(guides, growth);
  const double distribute =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  pass.setHairs(std::move(hairs), growth);
  const HairDetail all = pass.all();
  GrowthTimes times{};
  times.distribute_ms = distribute;
  times.nodes_ms = deviceMs(o.pictures, [&] { nodes.update(guides.positions, Pose{}); });
  times.growth_ms = deviceMs(o.pictures, [&] { pass.grow(nodes, all); });
  times.bytes = pass.vertices().bytes();
  const HairReference reference(guides, guides.positions, segments);
  const std::vector<GrownVertex> grown = readComputed(pass, nodes, 1);
  for (size_t v = 0; v < grown.size(); v += 997) {
    const Hair& hair = pass.hairs()[grown[v].hair];
    const Eigen::Vector3d exact = reference.at(hair, growth, static_cast<int>(grown[v].node)).position;
    times.error = std::max(times.error,
                           (grown[v].position.cast<double>() - exact).norm() / reference.guideLength(hair));
  }
  return times;
}

RenderStatistics timePasses(const RenderOptions& o, const Scene& scene, const HairGrowth& growth) {
  RenderSettings settings;
  settings.width = o.width;
  settings.height = o.height;
  settings.samples = o.samples;
  settings.segments = o.vertices - 1;
  settings.growth = growth;
  Renderer renderer(settings);
  GroomDescription groom;
  groom.guides = scene.groom.strands;
  BodyDescription body;
  body.mesh = scene.body;
  body.head_weights = scene.head_weights;
  renderer.setGroom(groom);
  renderer.setBody(body);
  GuideFrame frame;
  frame.positions = groom.guides.positions;
  Box box = body.mesh.bounds();
  for (const Vec3& p : groom.guides.positions) box.extend(Eigen::Vector3f(p));
  std::vector<RenderStatistics> pictures;
  for (int i = 0; i < o.pictures + 2; ++i) {
    renderer.draw(frame, orbit(box, 0.4f, 0.1f, 1.4f));
    const RenderStatistics statistics = renderer.statistics();
    if (i >= 2) pictures.push_back(statistics);
  }
  RenderStatistics middle = pictures.back();
  for (double RenderStatistics::*ms :
       {&RenderStatistics::guides_ms, &RenderStatistics::growth_ms, &RenderStatistics::shadow_ms,
        &RenderStatistics::body_ms, &RenderStatistics::hair_ms, &RenderStatistics::resolve_ms}) {
    std::vector<double> values;
    for (const RenderStatistics& s : pictures) values.push_back(s.*ms);
    middle.*ms = spreadOf(values).median;
  }
  return middle;
}

/// A groom's strands bound to a twentieth of them.
int runBound(const RenderOptions& o) {
  constexpr size_t kStrandsPerGuide = 20;
  gl::HeadlessContext context;
  Settings settings;
  settings.scene.groom = o.bound;
  settings.scene.units.unit_meters = o.unit_meters;
  settings.scene.body = o.body;
  BoundHairTrial trial(settings, kStrandsPerGuide);
  const double rest = trial.worstAtRest(), coded_rest = trial.worstAtRest(CodecOptions());
  const StrandSet& guides = trial.guides();
  GuideNodes nodes(trial.nodes().segments());
  nodes.setGroom(guides, true);
  const Spread nodes_ms = deviceMs(o.pictures, [&] { nodes.update(guides.positions, Pose{}); });
  const HairDetail all = trial.pass().all();
  const Spread growth_ms = deviceMs(o.pictures, [&] { trial.pass().grow(nodes, all); });
  std::vector<HairObstacle> obstacles = trial.obstacles();
  const size_t bodies = obstacles.size();
  trial.pass().bodies().setObstacles(std::move(obstacles));
  const double kept_rest = trial.worstAtRest(CodecOptions());
  const Spread kept_ms = deviceMs(o.pictures, [&] { trial.pass().grow(nodes, all); });
  trial.pass().bodies().setObstacles({});
  const BoundHairTrial::Shaken shaken = trial.shake();
  const auto hairs = static_cast<double>(trial.strands().strands());
  Bench bench;
  bench.name = "render";
  bench.params = {{"bound", o.bound.front().string()}, {"strands_per_guide", kStrandsPerGuide}};
  bench.more = {{"device", context.renderer()}};
  bench.heading =
      fmt::format("strands of {} bound to one in {} of them, on {}; RMS over a second of shaking\n",
                  o.bound.front().filename().string(), kStrandsPerGuide, context.renderer());
  bench.table = Table({{"case", "case"},
                       {"device"},
                       {"guides", "guides"},
                       {"hairs", "hairs"},
                       {"vertices", "vertices"},
                       {"guide_nodes_ms", "guide nodes, ms", "{:.3f}"},
                       {"growth_ms", "growth ms", "{:.3f}"},
                       {"growth_ms_min", "min", "{:.3f}"},
                       {"growth_ms_p95", "p95", "{:.3f}"},
                       {"growth_bytes", ""},
                       {"bodies", "bodies"},
                       {"growth_bodies_ms", "among them, ms", "{:.3f}"},
                       {"wire_bytes", "sent bytes"},
                       {"hair_bytes", "a hair", "{:.1f}"},
                       {"rest_mm", "at rest, worst mm", "{:.4f}"},
                       {"rest_delta16_mm", "over delta16", "{:.4f}"},
                       {"rest_bodies_mm", "among bodies", "{:.4f}"},
                       {"shader_um", "shader, worst um", "{:.2f}"},
                       {"bound_mm", "bound mm", "{:.2f}"},
                       {"seeded_mm", "seed-grown mm", "{:.2f}"},
                       {"motion_mm", "motion mm", "{:.2f}"},
                       {"stretch", "stretch", "{:.4f}"},
                       {"leaving_rest_mm", "leaving rest, mm", "{:.4f}"}});
  bench.table.add({{"case", "bound"},
                   {"device", context.renderer()},
                   {"guides", guides.strands()},
                   {"hairs", trial.strands().strands()},
                   {"vertices", trial.strands().vertices()},
                   {"guide_nodes_ms", nodes_ms.median},
                   {"growth_ms", growth_ms.median},
                   {"growth_ms_min", growth_ms.min},
                   {"growth_ms_p95", growth_ms.p95},
                   {"growth_bytes", trial.pass().boundVertices().bytes()},
                   {"bodies", bodies},
                   {"growth_bodies_ms", kept_ms.median},
                   {"wire_bytes", trial.wireBytes()},
                   {"hair_bytes", static_cast<double>(trial.wireBytes()) / hairs},
                   {"rest_mm", 1e3 * rest},
                   {"rest_delta16_mm", 1e3 * coded_rest},
                   {"rest_bodies_mm", 1e3 * kept_rest},
                   {"shader_um", 1e6 * shaken.worst_shader},
                   {"bound_mm", 1e3 * shaken.bound},
                   {"seeded_mm", 1e3 * shaken.seeded},
                   {"motion_mm", 1e3 * shaken.motion},
                   {"stretch", shaken.stretch},
                   {"leaving_rest_mm", 1e3 * shaken.leaving_rest}});
  print(bench, o.print);
  return 0;
}

int run(const RenderOptions& asked) {
  if (!asked.bound.empty()) return runBound(asked);
  gl::HeadlessContext context;
  RenderOptions o = asked;
  // The device may choose another number.
  o.samples = PictureBuffer(o.width, o.height, asked.samples).samples();
  const Scene scene = benchScene(o.scene, o.guides, 0, o.seed);
  Bench bench;
  bench.name = "render";
  bench.params = {{"scene", o.scene},   {"guides", o.guides},   {"vertices", o.vertices}, {"width", o.width},
                  {"height", o.height}, {"samples", o.samples}, {"seed", o.seed}};
  bench.more = {{"device", context.renderer()}};
  bench.heading =
      fmt::format("{} guides of scene {}, {} vertices a hair, {} x {}, {} samples, on {}\n", o.guides,
                  o.scene, o.vertices, o.width, o.height, o.samples, context.renderer());
  bench.table = Table({{"case", "case"},
                       {"device"},
                       {"guides"},
                       {"hairs"},
                       {"vertices"},
                       {"distribute_ms", "placed, on CPU", "{:.1f}"},
                       {"guide_nodes_ms", "guide nodes", "{:.3f}"},
                       {"growth_ms", "growth ms", "{:.3f}"},
                       {"growth_ms_min", "min", "{:.3f}"},
                       {"growth_ms_p95", "p95", "{:.3f}"},
                       {"hairs_per_second", "hairs/s", "{:.3g}"},
                       {"growth_bytes"},
                       {"growth_error", "error/length", "{:.1e}"},
                       {"guides_ms", "guides", "{:.3f}"},
                       {"grow_ms", "grow", "{:.3f}"},
                       {"shadow_ms", "shadow", "{:.3f}"},
                       {"body_ms", "body", "{:.3f}"},
                       {"hair_ms", "hair", "{:.3f}"},
                       {"resolve_ms", "resolve", "{:.3f}"},
                       {"device_bytes", ""},
                       {"hairs_drawn", "drawn"}});
  for (const int count : o.hairs) {
    HairGrowth growth;
    growth.hairs = static_cast<size_t>(count);
    growth.curl_radius = 0.003f;
    const GrowthTimes times = timeGrowth(o, scene.groom.strands, growth);
    nlohmann::json row{{"case", fmt::format("{} hairs", count)},
                       {"device", context.renderer()},
                       {"guides", o.guides},
                       {"hairs", count},
                       {"vertices", o.vertices},
                       {"distribute_ms", times.distribute_ms},
                       {"guide_nodes_ms", times.nodes_ms.median},
                       {"growth_ms", times.growth_ms.median},
                       {"growth_ms_min", times.growth_ms.min},
                       {"growth_ms_p95", times.growth_ms.p95},
                       {"growth_bytes", times.bytes},
                       {"hairs_per_second", count / (1e-3 * times.growth_ms.median)},
                       {"growth_error", times.error}};
    if (!o.growth_only) {
      const RenderStatistics s = timePasses(o, scene, growth);
      row.update({{"guides_ms", s.guides_ms},
                  {"grow_ms", s.growth_ms},
                  {"shadow_ms", s.shadow_ms},
                  {"body_ms", s.body_ms},
                  {"hair_ms", s.hair_ms},
                  {"resolve_ms", s.resolve_ms},
                  {"device_bytes", s.device_bytes},
                  {"hairs_drawn", s.hairs_drawn}});
    }
    bench.table.add(std::move(row));
  }
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addRenderBench(CLI::App& app) {
  const auto o = std::make_shared<RenderOptions>();
  app.add_option("--hairs", o->hairs, "numbers of hairs, one or more")
      ->check(CLI::Range(1, 4000000))
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--vertices", o->vertices, "vertices per hair")
      ->check(CLI::Range(2, 257))
      ->capture_default_str();
  app.add_option("--guides", o->guides)->check(CLI::Range(1, 1000000))->capture_default_str();
  addScene(app, o->scene);
  addSeed(app, o->seed);
  app.add_option("--width", o->width, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  app.add_option("--height", o->height, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  app.add_option("--samples", o->samples, "samples per pixel; the heading shows the device's number")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  app.add_option("--pictures", o->pictures, "timed pictures; the table has medians")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_flag("--growth-only", o->growth_only, "measure growth in compute shaders only, without drawing");
  app.add_option(
         "--bound", o->bound,
         "instead: files of a groom whose strands are bound to a twentieth of them, as they are sent, grown "
         "and, in a shake of the head, beside the simulation of every strand")
      ->delimiter(',');
  app.add_option("--body", o->body, "body of --bound, in its unit, which keeps hair out");
  app.add_option("--unit-meters", o->unit_meters,
                 "metres per unit of --bound; 0: as the files say, or guessed")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  addPrintOptions(app, o->print);
  return [o] { return run(*o); };
}

}  // namespace strandcast
