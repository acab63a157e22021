#include "apps/picture_options.h"

#include <CLI/CLI.hpp>
#include <numbers>

#include "apps/hair_obstacles.h"

namespace strandcast {
namespace {

/// An option whose values have names.
template <class Value>
void addChoice(CLI::Option_group& group, const char* name, Value& value,
               const std::vector<std::pair<std::string, Value>>& choices, const char* help) {
  std::vector<std::string> words;
  std::string chosen;
  for (const auto& [word, meaning] : choices) {
    words.push_back(word);
    if (meaning == value) chosen = word;
  }
  group
      .add_option_function<std::string>(
          name,
          [&value, choices](const std::string& word) {
            for (const auto& [known, meaning] : choices)
              if (known == word) value = meaning;
          },
          help)
      ->check(CLI::IsMember(words))
      ->type_name("NAME")
      ->default_str(chosen);
}

void addGrowthOptions(CLI::App& app, PictureOptions& options) {
  auto* group = app.add_option_group("Growth", "how the full head of hair follows the guides");
  RenderSettings& s = options.settings;
  HairGrowth& g = s.growth;
  group->add_option("--hairs", g.hairs, "grown from the guides")
      ->check(CLI::Range(1, 4000000))
      ->capture_default_str();
  group->add_option("--segments", s.segments, "per hair")->check(CLI::Range(1, 256))->capture_default_str();
  addChoice<Interpolation>(*group, "--interpolation", g.interpolation,
                           {{"multi", Interpolation::kMultiStrand},
                            {"single", Interpolation::kSingleStrand},
                            {"combined", Interpolation::kCombined}},
                           "between three guides, in locks about one, or from three to one");
  group->add_option("--clump-radius", g.clump_radius, "of a lock about one guide, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group
      ->add_option("--lock-profile", options.lock_profile,
                   "factors of the clump radius at root, middle and tip (1 0.7 0.4)")
      ->expected(3)
      ->check(CLI::Range(0.0, 10.0));
  group->add_option("--clump", g.clump, "combined: how far tips close in on one guide at most, 0 to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group
      ->add_option("--tip-deviation", g.tip_deviation,
                   "by which 30 % of the hairs stray near their tip, at most, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group
      ->add_option("--whole-deviation", g.whole_deviation,
                   "by which 10 % of the hairs stray along their whole length, at most, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group->add_option("--curl-radius", g.curl_radius, "of curls laid on the hair, m; 0 = none")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  group->add_option("--curl-pitch", g.curl_pitch, "length of hair in a turn of a curl, m")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  group->add_flag("--keep-out", options.keep_out,
                  "keep grown hair out of the body, whose distance field is baked for it once");
  group->add_option("--clearance", s.clearance, "that it keeps from the body, m")
      ->check(CLI::Range(0.0, 0.1))
      ->capture_default_str();
  group->add_option("--density-map", options.density_map,
                    "PNG over the scalp (the groom's uvs, or longitude and latitude, face in the middle): "
                    "white grows all hairs, black none");
  group->add_option("--thickness-map", options.thickness_map,
                    "PNG over the scalp: the grey value times the hair's width");
  group->add_option("--hair-seed", g.seed, "of the hairs' random numbers")->capture_default_str();
  addChoice<GrowthPath>(*group, "--growth", s.growth_path,
                        {{"compute", GrowthPath::kCompute}, {"tessellator", GrowthPath::kTessellator}},
                        "where hair is grown; the same hair");
}

void addShadowOptions(CLI::App& app, PictureOptions& options) {
  auto* group =
      app.add_option_group("Shadow", "deep opacity maps of the hair beside a depth map of the body");
  RenderSettings& s = options.settings;
  OpacityLayers& o = s.opacity;
  addChoice<bool>(*group, "--shadows", s.shadows, {{"off", false}, {"on", true}}, "of hair and body");
  group->add_option("--shadow-layers", o.layers, "of the hair's opacity map")
      ->check(CLI::IsMember({3, 7, 11, 15}))
      ->capture_default_str();
  addChoice<LayerSizes>(*group, "--layer-sizes", o.sizes,
                        {{"constant", LayerSizes::kConstant},
                         {"linear", LayerSizes::kLinear},
                         {"power-of-two", LayerSizes::kPowerOfTwo},
                         {"fibonacci", LayerSizes::kFibonacci}},
                        "how the layers grow from the front on");
  addChoice<BeyondLayers>(*group, "--beyond-layers", o.beyond,
                          {{"ignore", BeyondLayers::kIgnore},
                           {"last", BeyondLayers::kLastLayer},
                           {"reach", BeyondLayers::kReach}},
                          "hair behind the last layer casts no shadow, counts in it, or there is none");
  group->add_option("--shadow-depth", o.depth, "of all layers together, m; not used with reach")
      ->check(CLI::Range(1e-4, 1000.0))
      ->capture_default_str();
  group->add_option("--shadow-map", o.map_size, "texels a side")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  group->add_option("--shadow-filter", o.filter, "texels to either side that are averaged")
      ->check(CLI::Range(0, 4))
      ->capture_default_str();
}

}  // namespace

void addPictureOptions(CLI::App& app, PictureOptions& options) {
  auto* picture = app.add_option_group("Picture", "how it looks");
  RenderSettings& s = options.settings;
  picture->add_option("--width", s.width, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  picture->add_option("--height", s.height, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  picture->add_option("--samples", s.samples, "per pixel (multisampling)")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  addChoice<HairCoverage>(
      *picture, "--coverage", s.coverage,
      {{"stochastic", HairCoverage::kStochastic}, {"alpha", HairCoverage::kAlphaToCoverage}},
      "of hairs thinner than a pixel: other samples for each hair, or alpha to coverage");
  picture->add_option("--supersampling", s.supersampling, "for stills: so many times as many pixels a side")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  addChoice<PixelFilter>(*picture, "--filter", s.filter,
                         {{"box", PixelFilter::kBox},
                          {"tent", PixelFilter::kTent},
                          {"gaussian", PixelFilter::kGaussian},
                          {"mitchell", PixelFilter::kMitchell}},
                         "of supersampling, the softest to the sharpest: tent, gaussian, box, mitchell");
  picture
      ->add_option("--detail", s.detail.part,
                   "part of the hairs that is drawn, the wider; 0: by their size in the picture")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  picture
      ->add_option(
          "--finest-hair", s.detail.finest_hair,
          "pixels: as many hairs are left out as make the rest this wide; 0: those that reach no sample")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  picture
      ->add_option("--longest-segment", s.detail.longest_segment,
                   "pixels: as many segments are left out as leave them no longer")
      ->check(CLI::Range(0.0, 10000.0))
      ->capture_default_str();
  addChoice<HairGeometry>(*picture, "--geometry", s.geometry,
                          {{"lines", HairGeometry::kLines}, {"strips", HairGeometry::kStrips}},
                          "hairs as lines with width as alpha, or as strips that face the eye");
  addGrowthOptions(app, options);
  addShadowOptions(app, options);
  picture->add_option("--hair-width", s.hair_width, "drawn width of a hair, m; more where few stand for many")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
  picture->add_option("--hair-color", options.hair_color, "red green blue, linear, 0 to 1")
      ->expected(3)
      ->check(CLI::Range(0.0, 1.0));
  picture
      ->add_option("--azimuth", options.azimuth, "of the camera about the head, degrees; 0 looks at the face")
      ->capture_default_str();
  picture->add_option("--elevation", options.elevation, "of the camera, degrees")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  picture->add_option("--zoom", options.zoom, "1 fills the picture with the hair")
      ->check(CLI::Range(0.05, 50.0))
      ->capture_default_str();
}

RenderSettings renderSettings(const PictureOptions& options) {
  RenderSettings settings = options.settings;
  if (options.hair_color.size() == 3) settings.hair_color = Vec3(options.hair_color.data());
  if (options.lock_profile.size() == 3) settings.growth.lock_profile = Vec3(options.lock_profile.data());
  const auto map = [](const std::filesystem::path& file) {
    return file.empty() ? nullptr : std::make_shared<const ScalpMap>(readScalpMap(file));
  };
  settings.growth.density = map(options.density_map);
  settings.growth.thickness = map(options.thickness_map);
  return settings;
}

Box pictureBox(const GroomDescription& groom, const BodyDescription& body) {
  Box box;
  for (const Vec3& p : groom.guides.positions) box.extend(Eigen::Vector3f(p));
  if (body.mesh.empty()) return box;
  // The head stays in the picture under short hair, a whole figure does not shrink the hair to a dot.
  Box around(box.min() - box.sizes() * 0.35f, box.max() + box.sizes() * 0.35f);
  return box.merged(around.intersection(body.mesh.bounds()));
}

void setPicture(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body) {
  renderer.setGroom(groom);
  renderer.setBody(body);
}

void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body) {
  if (options.keep_out) renderer.setObstacles(hairObstacles(colliders, body));
}

Camera pictureCamera(const PictureOptions& options, const Box& box) {
  const auto radians = [](double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); };
  return orbit(box, radians(options.azimuth), radians(options.elevation), static_cast<float>(options.zoom));
}

}  // namespace strandcast
