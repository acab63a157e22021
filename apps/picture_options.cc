#include "apps/picture_options.h"

#include <CLI/CLI.hpp>
#include <numbers>

namespace strandcast {

void addPictureOptions(CLI::App& app, PictureOptions& options) {
  auto* picture = app.add_option_group("Picture", "how it looks");
  RenderSettings& s = options.settings;
  picture->add_option("--width", s.width, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  picture->add_option("--height", s.height, "pixels")->check(CLI::Range(16, 16384))->capture_default_str();
  picture->add_option("--samples", s.samples, "per pixel (multisampling)")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  picture->add_option("--hairs", s.hairs, "grown from the guides")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  picture->add_option("--segments", s.segments, "per hair")->check(CLI::Range(1, 64))->capture_default_str();
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

Camera pictureCamera(const PictureOptions& options, const Box& box) {
  const auto radians = [](double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); };
  return orbit(box, radians(options.azimuth), radians(options.elevation), static_cast<float>(options.zoom));
}

}  // namespace strandcast
