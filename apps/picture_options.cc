#include "apps/picture_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "apps/hair_obstacles.h"
#include "apps/number_range.h"
#include "apps/picture_arguments.h"
#include "core/error.h"

namespace strandcast {
namespace {

std::string helpOf(const PictureSetting& setting) {
  return setting.info.unit.empty() ? setting.info.help
                                   : fmt::format("[{}] {}", setting.info.unit, setting.info.help);
}

std::string defaultOf(const PictureSetting& setting, const PictureOptions& options) {
  const std::vector<double> values = setting.get(options);
  return setting.choices.empty() ? fmt::format("{:g}", fmt::join(values, " "))
                                 : setting.choices[static_cast<size_t>(values[0])];
}

/// Runs `act` and converts its Error into CLI11's.
template <class Act>
void asOption(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    throw CLI::ValidationError(error.what());
  }
}

using Arguments = std::shared_ptr<PictureArguments>;

void addNumbers(CLI::Option_group& group, const PictureSetting& setting, const PictureOptions& options,
                const Arguments& arguments) {
  group
      .add_option_function<std::vector<double>>(
          "--" + setting.info.name,
          [arguments, &setting](const std::vector<double>& values) {
            asOption([&] { arguments->set(setting, values); });
          },
          helpOf(setting))
      ->expected(setting.info.components)
      ->check(inRange({setting.info.low, setting.info.high, setting.info.whole, setting.info.unit}))
      ->type_name(setting.info.whole ? "INT" : "NUMBER")
      ->default_str(defaultOf(setting, options))
      ->trigger_on_parse(setting.of_light);
}

void addChoice(CLI::Option_group& group, const PictureSetting& setting, const PictureOptions& options,
               const Arguments& arguments) {
  const auto set = [arguments, &setting](const std::string& word) {
    asOption([&] { arguments->set(setting, choiceNamed(setting, word, "--" + setting.info.name)); });
  };
  group.add_option_function<std::string>("--" + setting.info.name, set, helpOf(setting))
      ->check(CLI::IsMember(setting.choices))
      ->type_name("NAME")
      ->default_str(defaultOf(setting, options))
      ->trigger_on_parse(setting.of_light);
}

}  // namespace

void addPictureOptions(CLI::App& app, PictureOptions& options) {
  const std::map<std::string, std::string> kGroups{
      {"Picture", "size, sampling, level of detail and colours"},
      {"Camera", "direction and distance of the view"},
      {"Growth", "hairs grown from the guides"},
      {"Light", fmt::format("lights: each --light after the first adds one, {} at most; the options after a "
                            "--light apply to it",
                            kMaxLights)},
      {"Shadow", "deep opacity maps of the hair and a depth map of the body"},
      {"Marks", "overlays for debugging"}};
  const auto arguments = std::make_shared<PictureArguments>(options);
  app.add_option_function<std::string>(
         "--preset", [arguments](const std::string& file) { asOption([&] { arguments->readPreset(file); }); },
         "TOML file as the viewer saves it, of which the table [picture] is read; options override it")
      ->trigger_on_parse()
      ->type_name("FILE");
  CLI::Option_group* group = nullptr;
  std::string name;
  for (const PictureSetting& setting : pictureSettings()) {
    if (name != setting.group) group = app.add_option_group(setting.group, kGroups.at(setting.group));
    name = setting.group;
    if (setting.file != nullptr)
      group->add_option("--" + setting.info.name, options.*setting.file, setting.info.help)
          ->type_name("FILE");
    else if (setting.choices.empty())
      addNumbers(*group, setting, options, arguments);
    else
      addChoice(*group, setting, options, arguments);
  }
}

Box pictureBox(const GroomDescription& groom, const BodyDescription& body, float hair_reach) {
  Box box;
  for (const Vec3& p : groom.guides.positions) box.extend(Eigen::Vector3f(p));
  const Eigen::Vector3f beside = Eigen::Vector3f::Constant(hair_reach);
  Box hair;
  if (!box.isEmpty()) hair = Box(box.min() - beside, box.max() + beside);
  if (body.mesh.empty()) return hair;
  // The box includes the head under short hair, but not a whole figure, which would shrink the hair to a dot.
  Box around(box.min() - box.sizes() * 0.35f, box.max() + box.sizes() * 0.35f);
  return hair.merged(around.intersection(body.mesh.bounds()));
}

void setScene(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body) {
  renderer.setObstacles({});
  renderer.setGroom(groom);
  renderer.setBody(body);
}

namespace {

/// Whether colliders are parts of a skinned body, which the renderer draws at the colliders' poses.
bool haveBodyParts(const ColliderSet* colliders) {
  if (colliders == nullptr) return false;
  for (const Collider& collider : colliders->colliders)
    for (const ContactPrimitive& shape : collider.shapes)
      if (shape.field && !collider.follows_head) return true;
  return false;
}

}  // namespace

bool needsObstacles(const PictureOptions& options, const ColliderSet* colliders) {
  const RenderSettings& settings = options.settings;
  return settings.keep_out || settings.marks.needBodies() || haveBodyParts(colliders);
}

void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body) {
  std::vector<HairObstacle> obstacles;
  if (needsObstacles(options, colliders)) obstacles = hairObstacles(colliders, body);
  renderer.setObstacles(std::move(obstacles));
}

Camera pictureCamera(const PictureOptions& options, const Box& box) {
  const auto radians = [](double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); };
  return orbit(box, radians(options.azimuth), radians(options.elevation), static_cast<float>(options.zoom));
}

}  // namespace strandcast
