#include "options/picture_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/error.h"
#include "core/name_lookup.h"

namespace strandcast {
namespace {

// `ref` returns a reference to the setting in PictureOptions, const or not.

template <class Ref>
PictureSetting number(const char* group, const char* name, const char* unit, double low, double high,
                      const char* help, Ref ref) {
  using Value = std::remove_reference_t<decltype(ref(std::declval<PictureOptions&>()))>;
  PictureSetting setting{
      {name, unit, fmt::format("{:g} to {:g}", low, high), help, 1, low, high, std::is_integral_v<Value>},
      group};
  setting.get = [ref](const PictureOptions& o) { return std::vector{static_cast<double>(ref(o))}; };
  setting.set = [ref](PictureOptions& o, const std::vector<double>& v) { ref(o) = static_cast<Value>(v[0]); };
  return setting;
}

/// A setting in degrees whose value is stored in radians.
template <class Ref>
PictureSetting degrees(const char* group, const char* name, double low, double high, const char* help,
                       Ref ref) {
  PictureSetting setting = number(group, name, "degrees", low, high, help, ref);
  setting.get = [ref](const PictureOptions& o) {
    return std::vector{static_cast<double>(ref(o)) * 180 / std::numbers::pi};
  };
  setting.set = [ref](PictureOptions& o, const std::vector<double>& v) {
    ref(o) = static_cast<float>(v[0] * std::numbers::pi / 180);
  };
  return setting;
}

template <class Ref>
PictureSetting vector(const char* group, const char* name, const char* unit, double low, double high,
                      const char* help, Ref ref) {
  PictureSetting setting{{name, unit, fmt::format("each {:g} to {:g}", low, high), help, 3, low, high, false},
                         group};
  setting.get = [ref](const PictureOptions& o) {
    const Vec3& v = ref(o);
    return std::vector<double>{v.x(), v.y(), v.z()};
  };
  setting.set = [ref](PictureOptions& o, const std::vector<double>& v) {
    ref(o) = Eigen::Vector3d(v.data()).cast<float>();
  };
  return setting;
}

template <class Value, class Ref>
PictureSetting choice(const char* group, const char* name, const char* help,
                      std::vector<std::pair<std::string, Value>> choices, Ref ref) {
  PictureSetting setting{{name, "", "", help, 1, 0, static_cast<double>(choices.size() - 1), true}, group};
  for (const auto& [word, meaning] : choices) setting.choices.push_back(word);
  setting.get = [ref, choices](const PictureOptions& o) {
    const auto known =
        std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.second == ref(o); });
    return std::vector{static_cast<double>(known == choices.end() ? 0 : known - choices.begin())};
  };
  setting.set = [ref, choices](PictureOptions& o, const std::vector<double>& v) {
    ref(o) = choices[static_cast<size_t>(v[0])].second;
  };
  return setting;
}

template <class Ref>
PictureSetting flag(const char* group, const char* name, const char* help, Ref ref) {
  return choice<bool>(group, name, help, {{"off", false}, {"on", true}}, ref);
}

PictureSetting file(const char* group, const char* name, const char* help,
                    std::filesystem::path PictureOptions::*member) {
  PictureSetting setting{{name, "", "", help, 0, 0, 0, false}, group};
  setting.file = member;
  return setting;
}

#define AT(member) \
  [](auto& o) -> auto& { return o.member; }

void addPicture(std::vector<PictureSetting>& list) {
  const char* group = "Picture";
  list.push_back(number(group, "width", "pixels", 16, 16384, "size of the picture", AT(settings.width)));
  list.push_back(number(group, "height", "pixels", 16, 16384, "size of the picture", AT(settings.height)));
  list.push_back(number(group, "samples", "", 1, 8,
                        "samples per pixel (multisampling); the device may round it; see the summary",
                        AT(settings.samples)));
  list.push_back(choice<HairCoverage>(
      group, "coverage",
      "coverage of hairs thinner than a pixel: stochastic (samples chosen per hair) or alpha to coverage, "
      "which makes overlapping hair too thin",
      {{"stochastic", HairCoverage::kStochastic}, {"alpha", HairCoverage::kAlphaToCoverage}},
      AT(settings.coverage)));
  list.push_back(number(group, "supersampling", "", 1, 4, "supersampling factor per side, for stills",
                        AT(settings.supersampling)));
  list.push_back(choice<PixelFilter>(
      group, "filter", "filter of supersampling; from softest to sharpest: tent, gaussian, box, mitchell",
      {{"box", PixelFilter::kBox},
       {"tent", PixelFilter::kTent},
       {"gaussian", PixelFilter::kGaussian},
       {"mitchell", PixelFilter::kMitchell}},
      AT(settings.filter)));
  list.push_back(number(group, "detail", "", 0, 1,
                        "fraction of the hairs that is drawn, each wider to cover the same area; 0: chosen "
                        "by size in the picture",
                        AT(settings.detail.part)));
  list.push_back(number(group, "finest-hair", "pixels", 0, 100,
                        "drop hairs until the rest is this wide; 0: only those that cover no sample",
                        AT(settings.detail.finest_hair)));
  list.push_back(number(group, "longest-segment", "pixels", 0, 10000, "merge segments up to this length",
                        AT(settings.detail.longest_segment)));
  list.push_back(number(group, "detail-hysteresis", "", 0, 1,
                        "fraction by which hair may shrink in the picture before more is dropped",
                        AT(settings.detail.hysteresis)));
  list.push_back(flag(group, "cull", "do not grow hair outside the picture", AT(settings.cull)));
  list.push_back(choice<HairGeometry>(group, "geometry",
                                      "hairs as lines with width as alpha, or as strips that face the "
                                      "camera; with --growth tessellator, lines",
                                      {{"lines", HairGeometry::kLines}, {"strips", HairGeometry::kStrips}},
                                      AT(settings.geometry)));
  list.push_back(number(group, "hair-width", "m", 1e-6, 0.1,
                        "drawn width of a hair; choose a larger width where few hairs represent many",
                        AT(settings.hair_width)));
  list.push_back(vector(group, "hair-color", "", 0, 1, "red green blue, linear", AT(settings.hair_color)));
  list.push_back(vector(group, "body-color", "", 0, 1, "red green blue, linear", AT(settings.body_color)));
  list.push_back(vector(group, "background", "", 0, 1,
                        "red green blue, linear; 0.85 of it in the middle, a quarter of it in the corners; "
                        "also the albedo of the ground",
                        AT(settings.background)));
  list.push_back(number(group, "exposure", "stops", -20, 20, "each doubles the light that is shown",
                        AT(settings.exposure)));
  list.push_back(vector(group, "white-balance", "", 0.01, 1,
                        "red green blue, linear: the colour of light that is shown neutral",
                        AT(settings.white_balance)));
}

void addCamera(std::vector<PictureSetting>& list) {
  const char* group = "Camera";
  list.push_back(number(
      group, "azimuth", "degrees", -36000, 36000,
      "of the camera around the hair; 0 views along -z, into the face of a head that faces +z", AT(azimuth)));
  list.push_back(
      number(group, "elevation", "degrees", -89, 89, "of the camera above the horizon", AT(elevation)));
  list.push_back(number(group, "zoom", "", 0.05, 50,
                        "magnification; at 1 the bounding sphere of hair and head fills the picture's height",
                        AT(zoom)));
}

void addGrowth(std::vector<PictureSetting>& list) {
  const char* group = "Growth";
  list.push_back(number(group, "hairs", "", 1, 4000000, "number of hairs grown from the guides",
                        AT(settings.growth.hairs)));
  list.push_back(number(group, "segments", "", 1, 256, "segments per hair", AT(settings.segments)));
  list.push_back(choice<Interpolation>(group, "interpolation",
                                       "multi: between three guides; single: locks around one guide; "
                                       "combined: from three guides at the root to one at the tip",
                                       {{"multi", Interpolation::kMultiStrand},
                                        {"single", Interpolation::kSingleStrand},
                                        {"combined", Interpolation::kCombined}},
                                       AT(settings.growth.interpolation)));
  list.push_back(number(group, "clump-radius", "m", 0, 1, "radius of a lock around one guide",
                        AT(settings.growth.clump_radius)));
  list.push_back(vector(group, "lock-profile", "", 0, 10,
                        "factors of the clump radius at root, middle and tip",
                        AT(settings.growth.lock_profile)));
  list.push_back(number(group, "clump", "", 0, 1,
                        "combined: greatest fraction by which tips converge on one guide",
                        AT(settings.growth.clump)));
  list.push_back(number(group, "tip-deviation", "m", 0, 1,
                        "greatest deviation of 30 % of the hairs near their tip",
                        AT(settings.growth.tip_deviation)));
  list.push_back(number(group, "whole-deviation", "m", 0, 1,
                        "greatest deviation of 10 % of the hairs along their whole length",
                        AT(settings.growth.whole_deviation)));
  list.push_back(number(group, "curl-radius", "m", 0, 1, "radius of curls added to the hair; 0 = none",
                        AT(settings.growth.curl_radius)));
  list.push_back(number(group, "curl-pitch", "m", 0.001, 100, "hair length per turn of a curl",
                        AT(settings.growth.curl_pitch)));
  list.push_back(file(group, "curl-example",
                      "groom file (.tfx, .hair, .obj, .usda) with a strand whose curl (offset from its "
                      "smoothed axis) is applied to the hair, scaled with length, rotated per lock",
                      &PictureOptions::curl_example));
  list.push_back(number(group, "curl-strand", "", 0, 1e9, "index of the strand in the curl-example, from 0",
                        AT(curl_strand)));
  list.push_back(flag(group, "keep-out",
                      "keep grown hair out of the body; bakes the body's distance field once",
                      AT(settings.keep_out)));
  list.push_back(number(group, "clearance", "m", 0, 0.1, "distance that grown hair keeps from the body",
                        AT(settings.clearance)));
  list.push_back(file(group, "density-map",
                      "PNG over the scalp (the groom's uvs, or longitude and latitude, face in the middle): "
                      "white grows all hairs, black none",
                      &PictureOptions::density_map));
  list.push_back(file(group, "thickness-map", "PNG over the scalp: factor of the hair's width",
                      &PictureOptions::thickness_map));
  list.push_back(file(group, "importance-map",
                      "PNG over the scalp: the level of detail drops hairs of dark pixels first",
                      &PictureOptions::importance_map));
  list.push_back(
      number(group, "hair-seed", "", 0, 1e15, "seed of the hairs' random numbers", AT(settings.growth.seed)));
  list.push_back(choice<GrowthPath>(
      group, "growth",
      "where hair is grown: a compute shader, or the tessellator, which draws the same hair as lines",
      {{"compute", GrowthPath::kCompute}, {"tessellator", GrowthPath::kTessellator}},
      AT(settings.growth_path)));
}

void addShading(std::vector<PictureSetting>& list) {
  list.push_back(choice<HairShading>(
      "Light", "shading", "light hair at its vertices and interpolate the colours, or in every fragment",
      {{"vertex", HairShading::kVertex}, {"fragment", HairShading::kFragment}}, AT(settings.shading)));
}

/// Adds the settings of one light.
void addLights(std::vector<PictureSetting>& list) {
  const char* group = "Light";
  const size_t first = list.size();
  list.push_back(choice<LightKind>(
      group, "light",
      "directional: parallel, as the sun's; point: from a point in all directions; spot: from a point within "
      "a cone; rectangle: an area that shines to one side, which the renderer draws as a wide spot",
      {{"directional", LightKind::kDirectional},
       {"point", LightKind::kPoint},
       {"spot", LightKind::kSpot},
       {"rectangle", LightKind::kRectangle}},
      AT(settings.lights[o.light].kind)));
  list.push_back(
      number(group, "light-intensity", "", 0, 10000,
             "irradiance relative to the sun that the picture is exposed for; of other lights than "
             "directional ones at 1 m, falling with the inverse square of the distance",
             AT(settings.lights[o.light].intensity)));
  list.push_back(vector(group, "light-color", "", 0, 1,
                        "red green blue, linear, relative to the sun's colour",
                        AT(settings.lights[o.light].color)));
  list.push_back(
      vector(group, "light-direction", "", -1, 1,
             "direction in which the light travels; of a spot or rectangle, its axis; not used by point",
             AT(settings.lights[o.light].direction)));
  list.back().is_direction = true;
  list.push_back(
      vector(group, "light-position", "m", -1000, 1000,
             "position of a light that is not directional, Y up; shadows fade from 65 to 75 degrees off the "
             "direction to the middle of the hair",
             AT(settings.lights[o.light].position)));
  list.push_back(
      degrees(group, "light-cone", 1, 85, "half angle of a spot's cone", AT(settings.lights[o.light].cone)));
  list.push_back(number(group, "light-edge", "", 0, 1,
                        "outer fraction of a spot's cone over which its light fades; 0 is sharp",
                        AT(settings.lights[o.light].cone_edge)));
  list.push_back(number(group, "light-width", "m", 1e-3, 100, "horizontal side of a rectangle",
                        AT(settings.lights[o.light].width)));
  list.push_back(number(group, "light-height", "m", 1e-3, 100, "other side of a rectangle",
                        AT(settings.lights[o.light].height)));
  list.push_back(flag(group, "light-shadow", "hair and body cast shadows of this light",
                      AT(settings.lights[o.light].casts_shadow)));
  for (size_t i = first; i < list.size(); ++i) list[i].of_light = true;
}

void addShadow(std::vector<PictureSetting>& list) {
  const char* group = "Shadow";
  list.push_back(flag(group, "shadows", "shadows of hair and body, of every light with light-shadow",
                      AT(settings.shadows)));
  list.push_back(choice<int>(group, "shadow-layers", "layers of the hair's deep opacity map",
                             {{"3", 3}, {"7", 7}, {"11", 11}, {"15", 15}}, AT(settings.opacity.layers)));
  list.push_back(choice<LayerSizes>(group, "layer-sizes",
                                    "growth of the layers' depth from the front to the back",
                                    {{"constant", LayerSizes::kConstant},
                                     {"linear", LayerSizes::kLinear},
                                     {"power-of-two", LayerSizes::kPowerOfTwo},
                                     {"fibonacci", LayerSizes::kFibonacci}},
                                    AT(settings.opacity.sizes)));
  list.push_back(
      choice<BeyondLayers>(group, "beyond-layers",
                           "hair behind the last layer: ignore: it casts no shadow; last: it counts in the "
                           "last layer; reach: none is, the layers extend to the back of the hair",
                           {{"ignore", BeyondLayers::kIgnore},
                            {"last", BeyondLayers::kLastLayer},
                            {"reach", BeyondLayers::kReach}},
                           AT(settings.opacity.beyond)));
  list.push_back(number(group, "shadow-depth", "m", 1e-4, 1000,
                        "depth of all layers together; not used with reach", AT(settings.opacity.depth)));
  list.push_back(number(group, "shadow-map", "", 16, 8192, "texels per side", AT(settings.opacity.map_size)));
  list.push_back(number(group, "shadow-filter", "", 0, 4,
                        "radius in texels of the average over the shadow map", AT(settings.opacity.filter)));
}

void addMarks(std::vector<PictureSetting>& list) {
  const char* group = "Marks";
  list.push_back(
      flag(group, "mark-guides", "draw the guides' curves, each in its colour", AT(settings.marks.guides)));
  list.push_back(flag(group, "mark-tangents",
                      "draw the guides' tangents, 1 cm long; red, green, blue: components along x, y, z",
                      AT(settings.marks.tangents)));
  list.push_back(
      flag(group, "mark-collided",
           "mark guide vertices that touch the body yellow, those inside red; bakes the body's field once",
           AT(settings.marks.collided)));
  list.push_back(
      flag(group, "mark-inside",
           "mark vertices of grown hair inside the body (growth: compute); bakes the body's field once",
           AT(settings.marks.inside)));
}

#undef AT

}  // namespace

const std::vector<PictureSetting>& pictureSettings() {
  static const std::vector<PictureSetting> list = [] {
    std::vector<PictureSetting> all;
    for (const auto add : {addPicture, addCamera, addGrowth, addShading, addLights, addShadow, addMarks})
      add(all);
    return all;
  }();
  return list;
}

const PictureSetting& pictureSetting(const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (const PictureSetting& setting : pictureSettings()) {
    if (setting.info.name == name) return setting;
    names.push_back(setting.info.name);
  }
  throw Error("unknown setting of a picture '" + name + "'", where, didYouMean(name, names));
}

void setPicture(PictureOptions& options, const PictureSetting& setting, const std::vector<double>& values,
                const std::string& where) {
  const ParameterInfo& info = setting.info;
  if (setting.file != nullptr) throw Error("'" + info.name + "' takes the name of a file", where, "");
  if (values.size() != static_cast<size_t>(info.components))
    throw Error(fmt::format("'{}' takes {} number{}, not {}", info.name, info.components,
                            info.components == 1 ? "" : "s", values.size()),
                where, "");
  for (const double v : values)
    if (!std::isfinite(v) || v < info.low || v > info.high || (info.whole && std::fmod(v, 1) != 0))
      throw Error(fmt::format("'{}' = {} is out of range", info.name, v), where,
                  fmt::format("give {}{} {}", info.whole ? "a whole number, " : "", info.range, info.unit));
  if (setting.is_direction && std::ranges::all_of(values, [](double v) { return std::abs(v) < 1e-6; }))
    throw Error(fmt::format("'{}' has no direction", info.name), where, "give one that is not 0 0 0");
  setting.set(options, values);
}

std::vector<double> choiceNamed(const PictureSetting& setting, const std::string& choice,
                                const std::string& where) {
  const auto known = std::find(setting.choices.begin(), setting.choices.end(), choice);
  if (known == setting.choices.end())
    throw Error(fmt::format("'{}' cannot be '{}'", setting.info.name, choice), where,
                fmt::format("choose one of {}", fmt::join(setting.choices, ", ")));
  return {static_cast<double>(known - setting.choices.begin())};
}

void addLight(PictureOptions& options, const std::string& where) {
  std::vector<Light>& lights = options.settings.lights;
  if (lights.size() >= kMaxLights)
    throw Error(fmt::format("a picture has at most {} lights", kMaxLights), where, "leave one out");
  options.light = lights.size();
  lights.emplace_back();
}

RenderSettings renderSettings(const PictureOptions& options) {
  RenderSettings settings = options.settings;
  const auto map = [](const std::filesystem::path& file) {
    return file.empty() ? nullptr : std::make_shared<const ScalpMap>(readScalpMap(file));
  };
  settings.growth.density = map(options.density_map);
  settings.growth.thickness = map(options.thickness_map);
  settings.growth.importance = map(options.importance_map);
  if (!options.curl_example.empty())
    settings.growth.curl_example =
        std::make_shared<const CurlExample>(readCurlExample(options.curl_example, options.curl_strand));
  return settings;
}

}  // namespace strandcast
