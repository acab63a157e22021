#include "apps/render_suite.h"

#include <fmt/format.h>

#include <algorithm>

#include "gl/context.h"
#include "render/hair_readback.h"
#include "render/hair_reference.h"
#include "scenes/scene.h"

namespace strandcast {
namespace {

StrandSet guidesOf(const std::string& name, int strands) {
  SceneOptions options;
  options.name = name;
  options.strands = strands;
  options.vertices = 24;
  return makeScene(options).groom.strands;
}

/// Largest distance from the reference over the length of the guide, and of tangents.
struct GrowthError {
  double position = 0, tangent = 0;
};
GrowthError errorOf(const std::vector<GrownVertex>& grown, const std::vector<Hair>& hairs,
                    const HairGrowth& growth, const HairReference& reference) {
  GrowthError error;
  for (const GrownVertex& vertex : grown) {
    const Hair& hair = hairs[vertex.hair];
    const HairReference::Vertex exact =
        reference.at(hair, growth.lock_profile, static_cast<int>(vertex.node));
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
  constexpr int kSegments = 100;  // more than the tessellator has a patch
  gl::HeadlessContext context;
  std::vector<Case> cases;
  for (const std::string& scene : kGrowthScenes) {
    laboratory.checkStopped();
    const StrandSet guides = guidesOf(scene, 150);
    HairGrowth growth;
    growth.hairs = 500;
    growth.curl_radius = 0.004f;
    GuideNodes nodes(kSegments);
    nodes.setGroom(guides);
    nodes.update(guides.positions, Pose{});
    HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
    pass.setHairs(growHairs(guides, growth), growth.lock_profile);
    const HairDetail detail = pass.widths().detail(1);
    pass.grow(nodes, detail);
    const HairReference reference(guides, guides.positions, kSegments);
    for (const bool tessellator : {true, false}) {
      const GrowthError error =
          errorOf(tessellator ? readTessellated(pass, nodes, detail) : readComputed(pass, nodes, 1),
                  pass.hairs(), growth, reference);
      cases.push_back(
          absoluteCase({fmt::format("growth: {}, {}", scene, tessellator ? "tessellator" : "compute"),
                        "worst distance from double precision, of the length", ""},
                       error.position, 0, 1e-5));
      cases.back().note = fmt::format("{} hairs of {} segments on {}; tangents within {:.1e}",
                                      pass.hairs().size(), kSegments, context.renderer(), error.tangent);
    }
  }
  return cases;
}

}  // namespace

const Suite& renderSuite() {
  static const Suite suite{
      "render",
      "the renderer's shaders against slower exact paths",
      {{"hairs of every kind grown on the tessellator and in compute, against double precision",
        growthNames(), growthCases}}};
  return suite;
}

}  // namespace strandcast
