#include "validation/bound_hair_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/error.h"
#include "groom/bound_growth.h"
#include "groom/groom_operations.h"
#include "groom/hair_binding.h"
#include "render/bound_hairs.h"
#include "render/shader_validation.h"
#include "scenes/scene.h"
#include "service/scene_simulation.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

constexpr int kNodeSegments = 32;    // as RenderSettings
constexpr float kHairWidth = 1e-4f;  // m; growth does not depend on it

Scene sceneOf(const Settings& settings) {
  SceneOptions options = settings.scene;
  options.motion = "shake";
  return makeScene(options);
}

class MeanSquare {
 public:
  void add(double squared) {
    sum_ += squared;
    ++count_;
  }
  double root() const { return std::sqrt(sum_ / static_cast<double>(std::max<size_t>(count_, 1))); }

 private:
  double sum_ = 0;
  size_t count_ = 0;
};

/// Per strand, the seed-grown hair with the nearest root.
std::vector<size_t> nearestHairs(const StrandSet& strands, std::span<const Vec3> roots) {
  std::vector<size_t> nearest(strands.strands());
  for (size_t s = 0; s < strands.strands(); ++s) {
    float least = std::numeric_limits<float>::infinity();
    for (size_t h = 0; h < roots.size(); ++h) {
      const float distance = (roots[h] - strands.strand(s)[0]).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest[s] = h;
      }
    }
  }
  return nearest;
}

/// Hair grown from the guides by the renderer's defaults, as many hairs as there are strands.
class SeededHair {
 public:
  SeededHair(const StrandSet& guides, const StrandSet& strands)
      : pass_(GrowthPath::kCompute, HairGeometry::kLines) {
    HairGrowth growth;
    growth.hairs = strands.strands();
    hairs_ = growHairs(guides, growth);
    pass_.setHairs(hairs_, growth);
    GuideNodes nodes(kNodeSegments);
    nodes.setGroom(guides);
    nodes.update(guides.positions, {});
    grow(nodes);
    std::vector<Vec3> roots;
    for (size_t h = 0; h < hairs_.size(); ++h) roots.push_back(vertices_[h * (kNodeSegments + 1)].position);
    nearest_ = nearestHairs(strands, roots);
  }
  void grow(const GuideNodes& nodes) {
    pass_.grow(nodes, pass_.all());
    vertices_ = readComputed(pass_, nodes, 1);
  }
  /// The place for the fraction `along` of strand `s`.
  Vec3 at(size_t s, float along) const {
    const size_t hair = nearest_[s];
    const float place = along * hairs_[hair].extent * kNodeSegments;
    const auto node = std::min(static_cast<size_t>(place), static_cast<size_t>(kNodeSegments - 1));
    const Vec3 &a = vertices_[hair * (kNodeSegments + 1) + node].position,
               &b = vertices_[hair * (kNodeSegments + 1) + node + 1].position;
    return a + (place - static_cast<float>(node)) * (b - a);
  }

 private:
  HairPass pass_;
  std::vector<Hair> hairs_;
  std::vector<GrownVertex> vertices_;
  std::vector<size_t> nearest_;
};

}  // namespace

BoundHairTrial::BoundHairTrial(const Settings& settings, size_t strands_per_guide)
    : settings_(settings),
      scene_(sceneOf(settings)),
      nodes_(kNodeSegments),
      pass_(GrowthPath::kCompute, HairGeometry::kLines) {
  const size_t guides = std::max<size_t>(strands().strands() / strands_per_guide, 1);
  guides_ = subset(strands(), chooseGuides(strands(), guides));
  const std::vector<HairBinding> bindings = bindHairs(strands(), guides_);
  const std::vector<uint32_t> order = orderByGuide(bindings);
  scene_.groom.strands = subset(strands(), order);
  HairDescription hairs;
  hairs.hairs = strands();
  for (const uint32_t hair : order) hairs.bindings.push_back(bindings[hair]);
  for (const HairChunk& chunk : encodeHairs(hairs, guides_, kDefaultHairError)) {
    wire_bytes_ += chunk.payload.size();
    if (!decodeHairs(chunk, guides_, received_))
      throw Error("hairs that were encoded do not decode", scene_.name, "report this as a bug");
  }
  nodes_.setGroom(guides_, true);
  pass_.setHairs(boundHairs(received_, guides_, {}, kHairWidth), {},
                 std::make_unique<BoundHairs>(received_.hairs));
}

void BoundHairTrial::grow(std::span<const Vec3> guides, const Pose& head) {
  nodes_.update(guides, head);
  pass_.grow(nodes_, pass_.all());
}

std::vector<HairObstacle> BoundHairTrial::obstacles() const {
  std::vector<HairObstacle> obstacles;
  for (const RigidBody& body : scene_.bodies)
    for (const ContactPrimitive& shape : body.primitives)
      obstacles.push_back({shape, body.follows_head, kNoCollider, body.pose});
  return obstacles;
}

/// Per vertex of strands().
std::vector<Vec3> BoundHairTrial::grownBound() const {
  std::vector<Vec3> positions(strands().vertices());
  const auto per_hair = static_cast<size_t>(pass_.boundVertices().nodesPerHair());
  const std::vector<GrownVertex> grown = readBound(pass_);
  for (size_t i = 0; i < grown.size(); ++i) {
    const size_t s = pass_.hairs()[grown[i].hair].bound - 1, j = i % per_hair;
    if (j < strands().verticesOf(s)) positions[strands().offsets[s] + j] = grown[i].position;
  }
  return positions;
}

double BoundHairTrial::worstAtRest(const CodecOptions& codec) {
  GuideFrame frame;
  frame.positions = guides_.positions;
  GuideEncoder encoder(codec);
  encoder.setGroom(guides_);
  GuideDecoder decoder;
  decoder.setGroom(guides_);
  std::vector<Vec3> received(guides_.vertices());
  encoder.encodeAll(frame, [&](GuideChunk& chunk) {
    const std::span<Vec3> part = std::span(received).subspan(chunk.first_vertex, chunk.vertex_count);
    if (decoder.decode(chunk, part) != DecodeResult::kDone)
      throw Error("guides that were encoded do not decode", scene_.name, "report this as a bug");
  });
  grow(received, {});
  const std::vector<Vec3> grown = grownBound();
  double worst = 0;
  for (size_t v = 0; v < grown.size(); ++v)
    worst = std::max<double>(worst, (grown[v] - strands().positions[v]).norm());
  return worst;
}

double BoundHairTrial::worstLeavingRest(std::span<const Vec3> bent, const Pose& head) const {
  constexpr float kWorst = 4.6e-5f;  // m: there motionShare() takes most of a guide's motion
  std::vector<Vec3> near(bent.begin(), bent.end());
  for (size_t g = 0; g < guides_.strands(); ++g) {
    const uint32_t first = guides_.offsets[g], last = guides_.offsets[g + 1];
    float farthest = 1e-9f;
    for (uint32_t v = first; v < last; ++v)
      farthest = std::max(farthest, (bent[v] - head.apply(guides_.positions[v])).norm());
    for (uint32_t v = first; v < last; ++v) {
      const Vec3 rest = head.apply(guides_.positions[v]);
      near[v] = rest + (kWorst / farthest) * (bent[v] - rest);
    }
  }
  const auto grownWith = [&](const Pose& root) {
    return BoundHairReference(guides_, near, std::vector<Pose>(guides_.strands(), root), kNodeSegments);
  };
  // No guide is near rest where the root's motion leads a metre away.
  const BoundHairReference with = grownWith(head),
                           without = grownWith({head.position + Vec3(1, 0, 0), head.rotation});
  double worst = 0;
  for (size_t s = 0; s < received_.hairs.strands(); ++s) {
    const auto a = with.grow(received_.hairs.strand(s), received_.bindings[s]),
               b = without.grow(received_.hairs.strand(s), received_.bindings[s]);
    for (size_t j = 0; j < a.size(); ++j) worst = std::max(worst, (a[j].position - b[j].position).norm());
  }
  return worst;
}

BoundHairTrial::Shaken BoundHairTrial::shake() {
  constexpr double kFirst = 0.2, kLast = 1.0, kEvery = 0.1;  // s
  Scene few = scene_;
  few.groom.strands = guides_;
  Simulation all = makeSimulation(scene_, settings_), guides = makeSimulation(few, settings_);
  SeededHair seeded(guides_, strands());
  MeanSquare bound_off, seeded_off, motion, stretch;
  Shaken result;
  double next = kFirst;
  while (next < kLast + kEvery / 2) {
    for (Simulation* simulation : {&all, &guides}) {
      while (simulation->time() < next) {
        simulation->setHeadPose(
            scene_.motion(simulation->time() + static_cast<double>(simulation->parameters().time_step)));
        simulation->step();
      }
    }
    next += kEvery;
    const Pose head = guides.headPose();
    const std::span<const Vec3> truth = all.guides(), carriers = guides.guides();
    grow(carriers, head);
    seeded.grow(nodes_);
    const std::vector<Vec3> grown = grownBound();
    const BoundHairReference reference(guides_, carriers, std::vector<Pose>(guides_.strands(), head),
                                       kNodeSegments);
    for (size_t s = 0; s < strands().strands(); ++s) {
      const std::span<const Vec3> rest = strands().strand(s);
      const size_t first = strands().offsets[s];
      const float length = arcLength(rest);
      float run = 0;
      const auto exact = reference.grow(received_.hairs.strand(s), received_.bindings[s]);
      for (size_t j = 0; j < rest.size(); ++j) {
        if (j > 0) run += (rest[j] - rest[j - 1]).norm();
        const Vec3& place = truth[first + j];
        bound_off.add(static_cast<double>((grown[first + j] - place).squaredNorm()));
        seeded_off.add(
            static_cast<double>((seeded.at(s, run / std::max(length, 1e-9f)) - place).squaredNorm()));
        motion.add(static_cast<double>((head.apply(rest[j]) - place).squaredNorm()));
        result.worst_shader =
            std::max(result.worst_shader, (grown[first + j].cast<double>() - exact[j].position).norm());
      }
      const double change = static_cast<double>(
          arcLength(std::span<const Vec3>(grown).subspan(first, rest.size())) / std::max(length, 1e-9f) - 1);
      stretch.add(change * change);
    }
  }
  result.leaving_rest = worstLeavingRest(guides.guides(), guides.headPose());
  result.bound = bound_off.root();
  result.seeded = seeded_off.root();
  result.motion = motion.root();
  result.stretch = stretch.root();
  return result;
}

}  // namespace strandcast
