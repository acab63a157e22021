#include <fmt/format.h>
#include <Eigen/Core>

#include <cmath>

#include "gl/context.h"
#include "groom/procedural_groom.h"
#include "light/path_tracer.h"
#include "render/renderer.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

/// A white furnace of hair alone: its style, the sampling of the first scattering and the fibre's roughness.
struct FurnaceTrial {
  const char* name;
  HairStyle style;
  FirstDirection first;
  double roughness;
  uint32_t samples;  ///< per pixel
  double limit;      ///< %
};
// Uniform directions have a variance that only rough fibres keep small; 1.5 % is about four standard errors.
constexpr FurnaceTrial kFurnaceTrials[] = {
    {"hair furnace: straight", HairStyle::kStraight, FirstDirection::kByImportance, 0.3, 256, 0.3},
    {"hair furnace: curly", HairStyle::kCurly, FirstDirection::kByImportance, 0.3, 256, 0.3},
    {"hair furnace: straight, uniform", HairStyle::kStraight, FirstDirection::kUniform, 0.8, 96, 1.5}};

constexpr int kFurnaceSide = 64;  // pixels
constexpr size_t kFurnaceHairs = 100000;

/// All hair of a head at rest, as the renderer grows it.
PictureGeometry grownHead(HairStyle style) {
  gl::HeadlessContext context;
  context.makeCurrent();
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.growth.hairs = kFurnaceHairs;
  settings.lights.clear();
  Renderer renderer(settings);
  ProceduralGroomOptions options;
  options.style = style;
  GroomDescription groom;
  groom.guides = makeProceduralGroom(options).strands;
  renderer.setGroom(groom);
  GuideFrame frame;
  frame.positions = groom.guides.positions;
  return renderer.geometry(frame);
}

PathScene furnaceScene(PictureGeometry head, const FurnaceTrial& trial) {
  PathScene scene;
  Box box;
  for (const Vec3& p : head.positions) box.extend(Eigen::Vector3f(p));
  const Camera camera = orbit(box, 0.6f, 0.1f, 1.6f);
  scene.hair.absorption.assign(head.hairs(), {Vec3(Vec3::Zero()), Vec3(Vec3::Zero())});
  scene.hair.offsets = std::move(head.offsets);
  scene.hair.positions = std::move(head.positions);
  scene.hair.tangents = std::move(head.tangents);
  scene.hair.radii = std::move(head.widths);
  for (float& radius : scene.hair.radii) radius /= 2;
  scene.fibre.longitudinal_roughness = scene.fibre.azimuthal_roughness = trial.roughness;
  scene.sky = Sky::constant({1, 1, 1});
  scene.camera.view = viewMatrix(camera);
  scene.camera.vertical_fov = camera.vertical_fov;
  scene.width = scene.height = kFurnaceSide;
  scene.first_direction = trial.first;
  return scene;
}

Case furnaceCaseOf(const FurnaceTrial& trial, const Laboratory& laboratory) {
  laboratory.checkStopped();
  const PathTracer tracer(furnaceScene(grownHead(trial.style), trial));
  PathFilm film(kFurnaceSide, kFurnaceSide);
  for (uint32_t samples = 1; samples <= trial.samples; ++samples) {
    laboratory.checkStopped();
    tracer.trace(film, samples);
  }
  const FloatImage image = film.image();
  // The sky behind has the radiance 1, too: scattered light alone, over the share of hair.
  double sum = 0, weight = 0;
  for (size_t i = 0; i < film.size(); ++i) {
    sum += static_cast<double>(image.find("single.G")->at(i)) +
           static_cast<double>(image.find("multiple.G")->at(i));
    weight += static_cast<double>(image.find("hair")->at(i));
  }
  Case result = relativeCase({trial.name, "mean radiance of white hair in a white sky", ""}, sum / weight, 1,
                             trial.limit);
  result.note =
      fmt::format("{:.0f} paths, {} segments", weight * trial.samples, tracer.geometry().segments());
  return result;
}

std::vector<Case> furnaceCasesOfHair(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (const FurnaceTrial& trial : kFurnaceTrials) cases.push_back(furnaceCaseOf(trial, laboratory));
  return cases;
}

}  // namespace

void addHairFurnaceExperiments(std::vector<Experiment>& experiments) {
  std::vector<std::string> names;
  for (const FurnaceTrial& trial : kFurnaceTrials) names.emplace_back(trial.name);
  experiments.push_back({"white furnace of heads of 100,000 hairs, path traced", names, furnaceCasesOfHair});
}

}  // namespace strandcast
