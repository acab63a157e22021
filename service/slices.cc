#include "service/slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "options/output_folder.h"

namespace strandcast {
namespace {

using Colour = std::array<double, 3>;
constexpr Colour kAbove{0.70, 0.09, 0.17}, kBelow{0.13, 0.40, 0.67}, kHair{0.35, 0.22, 0.12},
    kSolid{0.6, 0.6, 0.6}, kArrow{0, 0, 0};
constexpr double kHairInk = 0.5;

double valueOf(const AirSample& sample, AirQuantity quantity) {
  switch (quantity) {
    case AirQuantity::kDensity:
      return static_cast<double>(sample.density);
    case AirQuantity::kWind:
      return static_cast<double>(sample.wind.norm());
    case AirQuantity::kPressure:
      return static_cast<double>(sample.pressure);
    case AirQuantity::kDivergence:
      break;
  }
  return static_cast<double>(sample.divergence);
}

constexpr const char* kQuantities[] = {"density", "wind", "pressure", "divergence"};  // by AirQuantity

const char* unitOf(AirQuantity quantity) {
  constexpr const char* kUnits[] = {"kg/m^3", "m/s", "Pa", "1/s"};
  return kUnits[static_cast<int>(quantity)];
}

const AirFields& fieldsOf(Simulation& simulation) {
  if (const AirFields* fields = airSystem(simulation.externalForces())) return *fields;
  throw Error("the grids of this backend cannot be drawn", simulation.backend().name(), "choose simd");
}

/// A picture of a square region of the world.
class Canvas {
 public:
  Canvas(const Box& box, int axis, int size)
      : right_(axis == 0 ? 2 : 0), up_(axis == 1 ? 2 : 1), axis_(axis), size_(size), box_(box) {
    image_.width = image_.height = size;
    image_.rgb.assign(size_t{3} * size * size, 255);
    pixel_ = box.sizes().maxCoeff() / static_cast<float>(size);
  }
  Vec3 pointOf(int x, int y) const {
    Vec3 point(box_.center());
    point[right_] = box_.min()[right_] + (static_cast<float>(x) + 0.5f) * pixel_;
    point[up_] = box_.max()[up_] - (static_cast<float>(y) + 0.5f) * pixel_;
    return point;
  }
  void blend(int x, int y, const Colour& colour, double part) {
    if (x < 0 || y < 0 || x >= size_ || y >= size_) return;
    for (size_t c = 0; c < 3; ++c) {
      uint8_t& value = image_.rgb[3 * (static_cast<size_t>(y) * size_ + static_cast<size_t>(x)) + c];
      value = static_cast<uint8_t>(std::lround(value + part * (255 * colour[c] - value)));
    }
  }
  void dot(const Vec3& point, const Colour& colour, double part) {
    const auto [x, y] = pixelOf(point);
    if (std::isfinite(x + y) && std::fabs(x) < 1e6f && std::fabs(y) < 1e6f)
      blend(static_cast<int>(x), static_cast<int>(y), colour, part);
  }
  void line(const Vec3& from, const Vec3& to) {
    const float length = (to - from).norm() / pixel_;
    for (float i = 0; i <= length; i += 0.5f)
      dot(from + (to - from) * (i / std::max(length, 1.0f)), kArrow, 1);
  }
  /// Draws the component of `way` (m) in the plane of the slice, centred at `middle`. Shorter than two
  /// pixels: nothing.
  void arrow(const Vec3& middle, Vec3 way) {
    way[axis_] = 0;
    if (way.norm() < 2 * pixel_) return;
    const Vec3 tip = middle + 0.5f * way;
    Vec3 side = Vec3::Zero();
    side[right_] = -way[up_];
    side[up_] = way[right_];
    line(middle - 0.5f * way, tip);
    line(tip, tip - 0.3f * way + 0.15f * side);
    line(tip, tip - 0.3f * way - 0.15f * side);
  }
  float distanceTo(const Vec3& point) const { return std::fabs(point[axis_] - box_.center()[axis_]); }
  Image take() { return std::move(image_); }

 private:
  std::pair<float, float> pixelOf(const Vec3& point) const {
    return {(point[right_] - box_.min()[right_]) / pixel_, (box_.max()[up_] - point[up_]) / pixel_};
  }
  int right_, up_, axis_, size_;
  Box box_;
  float pixel_;
  Image image_;
};

}  // namespace

AirQuantity airQuantity(const std::string& name) {
  for (int i = 0; i < 4; ++i)
    if (name == kQuantities[i]) return static_cast<AirQuantity>(i);
  throw Error("unknown grid quantity", name, "choose density, wind, pressure or divergence");
}

const char* settingsOf(AirQuantity quantity) {
  return quantity == AirQuantity::kDensity ? "--set volume_stiffness=1 or --set wind_grid=1"
                                           : "--set wind_grid=1";
}

bool isOnGrid(const AirFields& fields, AirQuantity quantity) {
  return quantity == AirQuantity::kDensity ? fields.hasDensity() : fields.hasWind();
}

bool isOnGrid(Simulation& simulation, AirQuantity quantity) {
  const AirFields& fields = fieldsOf(simulation);
  // Grids keep their last content once no parameter needs them.
  return simulation.externalForces()->isNeeded(simulation.parameters()) && isOnGrid(fields, quantity);
}

const AirFields& fieldsWith(Simulation& simulation, AirQuantity quantity) {
  const AirFields& fields = fieldsOf(simulation);
  if (!isOnGrid(simulation, quantity))
    throw Error(quantity == AirQuantity::kDensity ? "the simulation has no hair grid"
                                                  : "the simulation has no wind grid",
                kQuantities[static_cast<int>(quantity)], std::string("give ") + settingsOf(quantity));
  return fields;
}

AirSlice airSlice(const AirFields& fields, AirQuantity quantity, int axis, std::span<const Vec3> hair,
                  int size) {
  const Box box = fields.box();
  Canvas canvas(box, axis, size);
  std::vector<AirSample> samples;
  samples.reserve(static_cast<size_t>(size) * static_cast<size_t>(size));
  AirSlice out{{}, 0, unitOf(quantity)};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      samples.push_back(fields.at(canvas.pointOf(x, y)));
      out.full = std::max(out.full, std::fabs(valueOf(samples.back(), quantity)));
    }
  size_t next = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x, ++next) {
      const double value = valueOf(samples[next], quantity);
      if (samples[next].solid)
        canvas.blend(x, y, kSolid, 1);
      else if (out.full > 0)
        canvas.blend(x, y, value > 0 ? kAbove : kBelow, std::fabs(value) / out.full);
    }
  for (const Vec3& point : hair)
    if (canvas.distanceTo(point) < fields.cell()) canvas.dot(point, kHair, kHairInk);
  if (quantity == AirQuantity::kWind && out.full > 0) {
    const float apart = 2 * fields.cell(), longest = 0.9f * apart / static_cast<float>(out.full);
    const int step = std::max(1, static_cast<int>(apart / box.sizes().maxCoeff() * static_cast<float>(size)));
    for (int y = step / 2; y < size; y += step)
      for (int x = step / 2; x < size; x += step) {
        const AirSample& sample =
            samples[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)];
        if (!sample.solid) canvas.arrow(canvas.pointOf(x, y), sample.wind * longest);
      }
  }
  out.image = canvas.take();
  return out;
}

AirFilm::AirFilm(const std::string& quantity, const std::string& axis, int size,
                 const std::filesystem::path& folder)
    : name_(quantity),
      quantity_(airQuantity(quantity)),
      axis_(axis[0] - 'x'),
      size_(size),
      pictures_(folder) {}

bool AirFilm::canDraw(Simulation& simulation) const { return isOnGrid(simulation, quantity_); }
bool AirFilm::canDraw(const AirFields& fields) const { return isOnGrid(fields, quantity_); }
const char* AirFilm::settings() const { return settingsOf(quantity_); }

void AirFilm::draw(Simulation& simulation) { draw(fieldsWith(simulation, quantity_), simulation.guides()); }

void AirFilm::draw(const AirFields& fields, std::span<const Vec3> hair) {
  const AirSlice slice = airSlice(fields, quantity_, axis_, hair, size_);
  full_ = std::max(full_, slice.full);
  unit_ = slice.unit;
  pictures_.write(slice.image);
}

void AirFilm::addTo(Report& out) const {
  out.add("shown", "shown", name_);
  out.add("full", "largest value of all pictures", full_, unit_, 4);
  out.addCount("frames_drawn", "frames drawn", static_cast<uint64_t>(drawn()));
  out.add("out", "pictures", pictures_.pattern());
}

namespace {

constexpr int kLongSide = 900;  // pixels

/// Colour of a signed distance, m. `pixel`: size of a pixel, m. `line`: distance between thin lines, m.
std::array<double, 3> colour(double distance, double pixel, double line, double band) {
  if (std::fabs(distance) < pixel) return {0, 0, 0};
  constexpr std::array<double, 3> kOutside{0.13, 0.40, 0.67}, kInside{0.70, 0.09, 0.17};
  const std::array<double, 3>& full = distance > 0 ? kOutside : kInside;
  const double strength = 0.15 + 0.85 * std::min(1.0, std::fabs(distance) / (2 * band));
  const double to_line = std::fabs(std::remainder(distance, line));
  const double shade = to_line < 0.5 * pixel && std::fabs(distance) < 2 * band ? 0.8 : 1.0;
  std::array<double, 3> out{};
  for (int c = 0; c < 3; ++c) out[c] = shade * (1 + strength * (full[c] - 1));
  return out;
}

}  // namespace

Image fieldSlice(const DistanceField& field, int axis, double part) {
  const FieldGrid& grid = field.grid;
  // Axes to the right and upwards in the picture: views from the front, from above and from the side.
  const int right = axis == 0 ? 2 : 0, up = axis == 1 ? 2 : 1;
  std::array<double, 3> size{};
  for (int a = 0; a < 3; ++a) size[a] = double{grid.cell} * kBrickCells * grid.bricks[a];
  const double pixel = std::max(size[right], size[up]) / kLongSide;
  Image image;
  image.width = std::max(1, static_cast<int>(std::lround(size[right] / pixel)));
  image.height = std::max(1, static_cast<int>(std::lround(size[up] / pixel)));
  image.rgb.reserve(size_t{3} * image.width * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Vec3 p;
      p[axis] = static_cast<float>(grid.origin[axis] + part * size[axis]);
      p[right] = static_cast<float>(grid.origin[right] + (x + 0.5) * pixel);
      p[up] = static_cast<float>(grid.origin[up] + size[up] - (y + 0.5) * pixel);
      for (const double c : colour(field.at(p).distance, pixel, 4.0 * grid.cell, grid.band))
        image.rgb.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(c, 0.0, 1.0))));
    }
  return image;
}

std::vector<std::filesystem::path> writeFieldSlices(const DistanceField& field,
                                                    const std::filesystem::path& folder) {
  const OutputFolder made(folder);
  std::vector<std::filesystem::path> files;
  for (int axis = 0; axis < 3; ++axis)
    for (const int percent : {25, 50, 75}) {
      files.push_back(folder / fmt::format("{}_{}.png", "xyz"[axis], percent));
      writePng(files.back(), fieldSlice(field, axis, percent / 100.0));
    }
  return files;
}

}  // namespace strandcast
