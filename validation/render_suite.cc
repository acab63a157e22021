#include "validation/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/srgb.h"
#include "gl/context.h"
#include "render/renderer.h"
#include "render/shader_validation.h"
#include "scenes/scene.h"
#include "service/scene_simulation.h"
#include "validation/bound_hair_trial.h"

namespace strandcast {
namespace {

StrandSet guidesOf(const std::string& name, int strands) {
  SceneOptions options;
  options.name = name;
  options.strands = strands;
  options.vertices = 24;
  return makeScene(options).groom.strands;
}

/// Largest distance from the reference over the length of the guide, and largest difference of tangents.
struct GrowthError {
  double position = 0, tangent = 0;
};
GrowthError errorOf(const std::vector<GrownVertex>& grown, const std::vector<Hair>& hairs,
                    const HairGrowth& growth, const HairReference& reference) {
  GrowthError error;
  for (const GrownVertex& vertex : grown) {
    const Hair& hair = hairs[vertex.hair];
    const HairReference::Vertex exact = reference.at(hair, growth, static_cast<int>(vertex.node));
    error.position = worse(error.position, (vertex.position.cast<double>() - exact.position).norm() /
                                               reference.guideLength(hair));
    error.tangent = worse(error.tangent, (vertex.tangent.cast<double>() - exact.tangent).norm());
  }
  return error;
}

const std::vector<std::string> kGrowthScenes{"straight", "curly", "ponytail"};

std::vector<std::string> growthNames() {
  std::vector<std::string> names;
  for (const std::string& scene : kGrowthScenes)
    for (const char* path : {"tessellator", "compute"})
      names.push_back(fmt::format("growth: {}, {}", scene, path));
  return names;
}

std::vector<Case> growthCases(const Laboratory& laboratory) {
  constexpr int kSegments = 100;  // more segments than the tessellator has per patch
  gl::HeadlessContext context;
  std::vector<Case> cases;
  for (const std::string& scene : kGrowthScenes) {
    laboratory.checkStopped();
    const StrandSet guides = guidesOf(scene, 150);
    HairGrowth growth;
    growth.hairs = 500;
    growth.curl_radius = 0.004f;
    growth.curl_example =
        std::make_shared<const CurlExample>(curlOf(guidesOf("curly", 150).strand(7), "a strand of curly"));
    GuideNodes nodes(kSegments);
    nodes.setGroom(guides);
    nodes.update(guides.positions, Pose{});
    HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
    pass.setHairs(growHairs(guides, growth), growth);
    const HairDetail detail = pass.all();
    pass.grow(nodes, detail);
    const HairReference reference(guides, guides.positions, kSegments);
    for (const bool tessellator : {true, false}) {
      const GrowthError error =
          errorOf(tessellator ? readTessellated(pass, nodes, detail) : readComputed(pass, nodes, 1),
                  pass.hairs(), growth, reference);
      cases.push_back(
          absoluteCase({fmt::format("growth: {}, {}", scene, tessellator ? "tessellator" : "compute"),
                        "worst distance from double precision, over the length", ""},
                       error.position, 0, 1e-5));
      cases.back().note = fmt::format("{} hairs of {} segments on {}; tangents within {:.1e}",
                                      pass.hairs().size(), kSegments, context.renderer(), error.tangent);
    }
  }
  return cases;
}

const std::vector<std::string> kBoundScenes{"straight", "curly", "ponytail"};

std::vector<std::string> boundNames() {
  std::vector<std::string> names;
  for (const std::string& scene : kBoundScenes)
    for (const char* what :
         {"rest", "rest over delta16", "rest among bodies", "shader", "shake", "leaving rest"})
      names.push_back(fmt::format("bound: {}, {}", scene, what));
  return names;
}

std::vector<Case> boundCases(const Laboratory& laboratory) {
  constexpr double kMillimetre = 1e3, kMicrometre = 1e6;
  gl::HeadlessContext context;
  std::vector<Case> cases;
  for (const std::string& scene : kBoundScenes) {
    laboratory.checkStopped();
    Settings settings;
    settings.scene.name = scene;
    settings.scene.strands = 600;
    settings.scene.vertices = 24;
    settings.backend = "simd";
    BoundHairTrial trial(settings, 20);
    const double hairs = static_cast<double>(trial.strands().strands());
    cases.push_back(
        absoluteCase({fmt::format("bound: {}, rest", scene),
                      "worst distance from the artist's hair, through the codec, where guides rest", "mm"},
                     kMillimetre * trial.worstAtRest(), 0, 0.05));
    cases.back().note = fmt::format("{} hairs of {} guides, {:.1f} bytes a hair", hairs,
                                    trial.guides().strands(), static_cast<double>(trial.wireBytes()) / hairs);
    cases.push_back(absoluteCase({fmt::format("bound: {}, rest over delta16", scene),
                                  "the same, where guides come through their default codec, too", "mm"},
                                 kMillimetre * trial.worstAtRest(CodecOptions()), 0, 0.05));
    trial.pass().bodies().setObstacles(trial.obstacles());
    cases.push_back(absoluteCase({fmt::format("bound: {}, rest among bodies", scene),
                                  "the same, kept out of the scene's bodies as far as at rest", "mm"},
                                 kMillimetre * trial.worstAtRest(CodecOptions()), 0, 0.05));
    trial.pass().bodies().setObstacles({});
    const BoundHairTrial::Shaken shaken = trial.shake();
    cases.push_back(absoluteCase({fmt::format("bound: {}, shader", scene),
                                  "worst distance from double precision while the head shakes", "um"},
                                 kMicrometre * shaken.worst_shader, 0, 2));
    cases.push_back(
        absoluteCase({fmt::format("bound: {}, shake", scene),
                      "RMS distance from the strand simulated itself, over that of seed-grown hair", ""},
                     shaken.bound / shaken.seeded, 0, 0.8));
    cases.back().note =
        fmt::format("bound {:.2f} mm, seed-grown {:.2f} mm, motion {:.2f} mm; lengths change by {:.2f} %",
                    kMillimetre * shaken.bound, kMillimetre * shaken.seeded, kMillimetre * shaken.motion,
                    100 * shaken.stretch);
    cases.push_back(
        absoluteCase({fmt::format("bound: {}, leaving rest", scene),
                      "largest change by guides that count as at rest near it, bent as by the shake", "mm"},
                     kMillimetre * shaken.leaving_rest, 0, 0.1));
  }
  return cases;
}

/// Mean error of the transmittance: over all fragments, and over those that at least half of the light
/// reaches, where errors are visible.
struct ShadowError {
  double sum = 0, lit_sum = 0;
  size_t count = 0, lit = 0;

  void add(double looked_up, double exact) {
    const double error = std::abs(std::exp(-looked_up) - std::exp(-exact));
    sum += error;
    ++count;
    if (std::exp(-exact) < 0.5) return;
    lit_sum += error;
    ++lit;
  }
  double all() const { return sum / static_cast<double>(count); }
  double seen() const { return lit_sum / static_cast<double>(lit); }
};

/// Fragments of hair sorted by texel and distance from the light, with the optical depth before each.
class ExactShadow {
 public:
  ExactShadow(std::vector<LightFragment> fragments, int map_size)
      : fragments_(std::move(fragments)), size_(map_size) {
    std::sort(fragments_.begin(), fragments_.end(), [&](const LightFragment& a, const LightFragment& b) {
      return texel(a) != texel(b) ? texel(a) < texel(b) : a.depth < b.depth;
    });
    for (size_t i = 0; i < fragments_.size(); ++i) {
      const bool same = i > 0 && texel(fragments_[i]) == texel(fragments_[i - 1]);
      before_.push_back(same ? before_.back() + fragments_[i - 1].optical_depth : 0.0);
      near_ = std::min(near_, fragments_[i].depth);
      far_ = std::max(far_, fragments_[i].depth);
    }
  }
  const std::vector<LightFragment>& fragments() const { return fragments_; }
  double before(size_t i) const { return before_[i]; }

  /// Mean error of the transmittance over all fragments of an opacity shadow map (Kim and Neumann 2001). It
  /// has `slices` slices between the nearest and the farthest hair, with linear interpolation between them.
  ShadowError opacityShadowMapError(int slices) const {
    const double thick = (far_ - near_) / slices;
    std::vector<double> up_to(static_cast<size_t>(slices) + 1);  // optical depth up to each slice's plane
    ShadowError error;
    for (size_t first = 0, end = 0; first < fragments_.size(); first = end) {
      for (end = first; end < fragments_.size() && texel(fragments_[end]) == texel(fragments_[first]);) ++end;
      std::fill(up_to.begin(), up_to.end(), 0.0);
      for (size_t i = first; i < end; ++i)
        for (size_t s = slice(i, thick) + 1; s < up_to.size(); ++s) up_to[s] += fragments_[i].optical_depth;
      for (size_t i = first; i < end; ++i) {
        const double place = (fragments_[i].depth - near_) / thick;
        const size_t s = slice(i, thick);
        error.add(std::lerp(up_to[s], up_to[s + 1], std::min(place - static_cast<double>(s), 1.0)),
                  before_[i]);
      }
    }
    return error;
  }

 private:
  size_t texel(const LightFragment& f) const {
    return static_cast<size_t>(f.y) * static_cast<size_t>(size_) + static_cast<size_t>(f.x);
  }
  size_t slice(size_t i, double thick) const {
    return static_cast<size_t>(
        std::clamp((fragments_[i].depth - near_) / thick, 0.0, (far_ - near_) / thick - 0.5));
  }

  std::vector<LightFragment> fragments_;
  std::vector<double> before_;
  int size_;
  float near_ = 1, far_ = 0;
};

ShadowError errorOf(LightProbe& probe, const OpacityLayers& layers, const ExactShadow& exact) {
  std::vector<Vec3> points;
  const float texel = 1.0f / static_cast<float>(layers.map_size);
  for (const LightFragment& f : exact.fragments())
    points.emplace_back((f.x + 0.5f) * texel, (f.y + 0.5f) * texel, f.depth);
  const std::vector<LightAnswer> answers = probe.ask(layers, points);
  ShadowError error;
  for (size_t i = 0; i < answers.size(); ++i) error.add(answers[i].optical_depth, exact.before(i));
  return error;
}

const std::vector<std::string> kShadowNames{"shadow: 3 layers",
                                            "shadow: 7 layers",
                                            "shadow: 15 layers",
                                            "shadow: 7 layers, lit hair",
                                            "shadow: 15 layers, lit hair",
                                            "shadow: 7 layers, lamp"};

/// The error under a lamp's perspective projection; the limit is an opacity shadow map of as many slices.
Case lampCase(const RenderSettings& settings, OpacityLayers layers) {
  LightProbe probe(guidesOf("curly", 600), settings);
  const ExactShadow exact(probe.fragments(layers.map_size), layers.map_size);
  layers.layers = 7;
  return absoluteCase(
      {kShadowNames[5], "the same under a point light at the head, at every hair segment", ""},
      errorOf(probe, layers, exact).all(), 0, exact.opacityShadowMapError(7).all());
}

/// The limit of each number of layers is the error of what it must beat. 3 layers: opacity shadow maps of 3
/// slices; more layers: the next fewer layers. Lit hair: opacity shadow maps of 16 slices.
std::vector<Case> shadowCases(const Laboratory& laboratory) {
  gl::HeadlessContext context;
  RenderSettings settings;
  settings.growth.hairs = 10000;
  settings.hair_width = 2e-4f;
  LightProbe probe(guidesOf("curly", 600), settings);
  OpacityLayers layers;
  layers.map_size = 256;  // many hairs per texel
  const ExactShadow exact(probe.fragments(layers.map_size), layers.map_size);
  const ShadowError few = exact.opacityShadowMapError(3), some = exact.opacityShadowMapError(16),
                    many = exact.opacityShadowMapError(128);
  std::vector<Case> cases, lit;
  double beaten = few.all();
  for (const int count : {3, 7, 15}) {
    laboratory.checkStopped();
    layers.layers = count;
    const ShadowError error = errorOf(probe, layers, exact);
    cases.push_back(absoluteCase(
        {kShadowNames[cases.size()], "mean error of the transmittance at every hair segment", ""},
        error.all(), 0, beaten));
    beaten = error.all();
    if (count > 3)
      lit.push_back(absoluteCase({kShadowNames[2 + cases.size() - 1],
                                  "the same at hair segments with a transmittance of 0.5 or more", ""},
                                 error.seen(), 0, some.seen()));
  }
  cases[0].note = fmt::format("opacity shadow maps: 3 slices {:.4f}, 16 {:.4f}, 128 {:.4f}", few.all(),
                              some.all(), many.all());
  lit[0].note = fmt::format("opacity shadow maps: 3 slices {:.4f}, 16 {:.4f}, 128 {:.4f}", few.seen(),
                            some.seen(), many.seen());
  cases.insert(cases.end(), lit.begin(), lit.end());
  laboratory.checkStopped();
  settings.lights[0].kind = LightKind::kPoint;
  cases.push_back(lampCase(settings, layers));
  return cases;
}

/// Hairs of a head in motion, with a count of vertices inside its bodies.
class HairOnHead {
 public:
  HairOnHead() : nodes_(kSegments) {
    Settings settings;
    settings.scene.name = "straight";
    settings.scene.strands = 150;  // sparse, so that interpolated hair cuts corners
    settings.scene.vertices = 24;
    settings.scene.motion = "turn";
    settings.backend = "reference";
    const Scene scene = makeScene(settings.scene);
    Simulation simulation = makeSimulation(scene, settings);
    while (simulation.time() < 0.4) {
      simulation.setHeadPose(
          scene.motion(simulation.time() + static_cast<double>(simulation.parameters().time_step)));
      simulation.step();
    }
    head_ = simulation.headPose();
    const std::span<const Vec3> guides = simulation.guides();
    nodes_.setGroom(scene.groom.strands);
    nodes_.update(guides, head_);
    growth_.hairs = 4000;
    growth_.interpolation = Interpolation::kMultiStrand;
    hairs_ = growHairs(scene.groom.strands, growth_);
    for (const RigidBody& body : scene.bodies)
      for (const ContactPrimitive& shape : body.primitives) obstacles_.push_back({shape, body.follows_head});
  }

  /// Counts vertices deeper in a body than 1e-5 m. Near the root, a vertex may be as deep as the root is.
  size_t inside(GrowthPath path, bool kept_out) const {
    HairPass pass(path, HairGeometry::kLines);
    pass.setHairs(hairs_, growth_);
    pass.setClearance(1e-4f);
    if (kept_out) pass.bodies().setObstacles(obstacles_);
    pass.bodies().place(head_);
    const HairDetail detail = pass.all();
    pass.grow(nodes_, detail);
    const std::vector<GrownVertex> grown =
        path == GrowthPath::kCompute ? readComputed(pass, nodes_, 1) : readTessellated(pass, nodes_, detail);
    std::vector<float> root(hairs_.size(), 0);
    for (const GrownVertex& v : grown)
      if (v.node == 0) root[v.hair] = std::min(distance(v.position), 0.0f);
    return static_cast<size_t>(std::count_if(grown.begin(), grown.end(), [&](const GrownVertex& v) {
      const float allowed = v.node < kSegments / 20 ? root[v.hair] : 0;
      return distance(v.position) < allowed - 1e-5f;
    }));
  }
  size_t vertices() const { return hairs_.size() * (kSegments + 1); }

 private:
  static constexpr int kSegments = 40;

  float distance(const Vec3& point) const {
    float nearest = std::numeric_limits<float>::infinity();
    for (const HairObstacle& obstacle : obstacles_) {
      const Pose pose = obstacle.follows_head ? head_ : Pose{};
      nearest = std::min(nearest, signedDistance(moved(obstacle.shape, pose, pose, 1), point));
    }
    return nearest;
  }

  GuideNodes nodes_;
  HairGrowth growth_;
  std::vector<Hair> hairs_;
  std::vector<HairObstacle> obstacles_;
  Pose head_;
};

/// A ball moves 2 cm into a curtain of hair in steps. Returns the farthest motion of a vertex in one step
/// over that of the ball.
double largestJump() {
  StrandSet guides;
  for (int i = 0; i < 9; ++i) {
    const Vec3 root(0.02f * static_cast<float>(i % 3), 0, 0.02f * static_cast<float>(i / 3));
    std::vector<Vec3> points;
    for (int k = 0; k < 10; ++k) points.push_back(Vec3(root - Vec3(0, 0.02f * static_cast<float>(k), 0)));
    guides.append(points);
  }
  GuideNodes nodes(40);
  nodes.setGroom(guides);
  nodes.update(guides.positions, Pose{});
  HairGrowth growth;
  growth.hairs = 300;
  growth.interpolation = Interpolation::kMultiStrand;
  HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
  pass.setHairs(growHairs(guides, growth), growth);
  constexpr float kStep = 1e-4f;
  std::vector<GrownVertex> last;
  double largest = 0;
  for (int step = 0; step < 200; ++step) {
    ContactPrimitive ball;
    ball.a = Vec3(0.03f, -0.1f, -0.036f + kStep * static_cast<float>(step));
    ball.radius = 0.03f;
    pass.bodies().setObstacles({{ball, false}});
    pass.grow(nodes, pass.all());
    std::vector<GrownVertex> now = readComputed(pass, nodes, 1);
    for (size_t i = 0; i < last.size(); ++i)
      largest = std::max(largest, static_cast<double>((now[i].position - last[i].position).norm() / kStep));
    last = std::move(now);
  }
  return largest;
}

const std::vector<std::string> kBodyNames{"bodies: let in", "bodies: kept out, compute",
                                          "bodies: kept out, tessellator", "bodies: jump"};

std::vector<Case> bodyCases(const Laboratory& laboratory) {
  gl::HeadlessContext context;
  const HairOnHead head;
  const auto count = [](size_t n) { return static_cast<double>(n); };
  std::vector<Case> cases;
  // The number of penetrations without obstacles; without any, the cases below would test nothing.
  cases.push_back(atLeastCase({kBodyNames[0], "vertices inside, of hair without --keep-out", ""},
                              count(head.inside(GrowthPath::kCompute, false)), 1000, 0));
  cases.back().note = fmt::format("of {} vertices", head.vertices());
  laboratory.checkStopped();
  cases.push_back(absoluteCase({kBodyNames[1], "vertices inside", ""},
                               count(head.inside(GrowthPath::kCompute, true)), 0, 0));
  cases.push_back(absoluteCase({kBodyNames[2], "vertices inside", ""},
                               count(head.inside(GrowthPath::kTessellator, true)), 0, 0));
  laboratory.checkStopped();
  cases.push_back(absoluteCase(
      {kBodyNames[3], "greatest distance that a vertex moves, over that of the entering ball", ""},
      largestJump(), 0, 20));
  return cases;
}

/// Error of a picture at a level of detail, over the pixels that hair covers.
struct DetailError {
  double pixels = 0;  ///< mean difference, linear, of full white
  double area = 0;    ///< of the area covered, relative
};

double linearGreen(const Image& image, size_t pixel) { return linearOf(image.rgb[3 * pixel + 1] / 255.0); }

/// Pictures of a head from one distance.
class DetailPictures {
 public:
  DetailPictures(const std::string& scene, bool black) {
    SceneOptions make;
    make.name = scene;
    make.strands = 400;
    make.vertices = 24;
    groom_.guides = makeScene(make).groom.strands;
    for (const Vec3& p : groom_.guides.positions) box_.extend(Eigen::Vector3f(p));
    frame_.positions = groom_.guides.positions;
    settings_.width = settings_.height = 128;
    settings_.growth.hairs = 12000;
    settings_.geometry = HairGeometry::kStrips;  // the coverage of lines shorter than a pixel depends on the
                                                 // device
    if (!black) return;
    settings_.shadows = false;
    settings_.hair_color = Vec3::Zero();
    settings_.background = Vec3(0.8f, 0.8f, 0.8f);
  }
  struct Drawn {
    Image image;
    RenderStatistics statistics;
  };
  Drawn draw(bool full, bool hair, float zoom) {
    RenderSettings settings = settings_;
    if (full) settings.detail = {1, 0, 0};
    Renderer renderer(settings);
    renderer.setGroom(groom_);
    GuideFrame frame = frame_;
    if (!hair)
      for (Vec3& p : frame.positions) p.x() = std::numeric_limits<float>::quiet_NaN();
    renderer.draw(frame, orbit(box_, 0.5f, 0.1f, zoom));
    return {renderer.read(), renderer.statistics()};
  }

 private:
  RenderSettings settings_;
  GroomDescription groom_;
  GuideFrame frame_;
  Box box_;
};

const std::vector<std::string> kDetailNames{"detail: pixels", "detail: area"};

std::vector<Case> detailCases(const Laboratory& laboratory) {
  gl::HeadlessContext context;
  DetailError worst;
  std::string pixels_note, area_note;
  for (const std::string scene : {"straight", "wavy"}) {
    DetailPictures shaded(scene, false), black(scene, true);
    for (float zoom = 2; zoom > 0.12f; zoom *= 0.5f) {
      laboratory.checkStopped();
      const DetailPictures::Drawn full = shaded.draw(true, true, zoom), less = shaded.draw(false, true, zoom),
                                  bare = shaded.draw(true, false, zoom);
      double difference = 0;
      size_t covered = 0;
      for (size_t i = 0; i < full.image.rgb.size() / 3; ++i) {
        if (std::abs(linearGreen(full.image, i) - linearGreen(bare.image, i)) < 0.002) continue;
        difference += std::abs(linearGreen(less.image, i) - linearGreen(full.image, i));
        ++covered;
      }
      const DetailPictures::Drawn black_full = black.draw(true, true, zoom),
                                  black_less = black.draw(false, true, zoom),
                                  black_bare = black.draw(true, false, zoom);
      double area_full = 0, area_less = 0;
      for (size_t i = 0; i < black_full.image.rgb.size() / 3; ++i) {
        const double bright = linearGreen(black_bare.image, i);
        area_full += 1 - linearGreen(black_full.image, i) / bright;
        area_less += 1 - linearGreen(black_less.image, i) / bright;
      }
      difference /= static_cast<double>(std::max<size_t>(covered, 1));
      const double area = std::abs(area_less / area_full - 1);
      worst = {std::max(worst.pixels, difference), std::max(worst.area, area)};
      const std::string at =
          fmt::format("{} {} x {}: ", scene, less.statistics.hairs_drawn, less.statistics.segments_drawn);
      pixels_note += fmt::format("{}{:.4f}; ", at, difference);
      area_note += fmt::format("{}{:.4f}; ", at, area);
    }
  }
  std::vector<Case> cases;
  cases.push_back(
      absoluteCase({kDetailNames[0],
                    "worst mean difference from full detail over pixels with hair, relative to white", ""},
                   worst.pixels, 0, 0.02));
  cases.back().note = pixels_note;
  cases.push_back(absoluteCase({kDetailNames[1], "worst difference of the covered area from full detail", ""},
                               worst.area, 0, 0.03));
  cases.back().note = area_note;
  return cases;
}

}  // namespace

const Suite& renderSuite() {
  static const Suite suite{
      "render",
      "the renderer's shaders against slower exact methods",
      {{"hairs of every kind grown by the tessellator and by compute shaders, against double precision",
        growthNames(), growthCases},
       {"hairs bound to a twentieth of them: as sent, in shaders, and in motion", boundNames(), boundCases},
       {"deep opacity maps of a head of curls against the exact opacity along the light's rays", kShadowNames,
        shadowCases},
       {"grown hair of a moving head, kept out of its bodies; a ball that enters hair", kBodyNames,
        bodyCases},
       {"a head from near to far, at the level of detail of its size and in full detail", kDetailNames,
        detailCases}}};
  return suite;
}

}  // namespace strandcast
