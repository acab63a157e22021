#include "light/sky.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "kernels/scalar_picture.h"

namespace strandcast {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Array3d arrayOf(const kernels::f32::real3& v) { return {v.x, v.y, v.z}; }

bool isRadiance(double value) { return value >= 0 && std::isfinite(value); }

/// The interval of a cumulative table, from `first` on, that holds `target`, and the fraction within it.
struct SkyInterval {
  size_t index;
  double part;
};
SkyInterval skyIntervalAt(const double* first, size_t count, double target) {
  const double* above = std::upper_bound(first, first + count + 1, target);
  const auto index = std::min(static_cast<size_t>(std::max<std::ptrdiff_t>(above - first - 1, 0)), count - 1);
  const double width = first[index + 1] - first[index];
  return {index, width > 0 ? std::clamp((target - first[index]) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

Sky Sky::constant(const Eigen::Array3d& radiance) {
  for (const double value : radiance)
    if (!isRadiance(value))
      throw Error(fmt::format("the radiance of the sky is {:g}", value), "constant sky",
                  "give numbers of 0 or more");
  Sky sky;
  sky.below_ = sky.above_ = sky.mean_ = radiance;
  return sky;
}

Sky Sky::ambient() {
  Sky sky;
  sky.below_ = arrayOf(kernels::f32::skyBelow());
  sky.above_ = arrayOf(kernels::f32::skyAbove());
  sky.mean_ = (sky.below_ + sky.above_) / 2;
  return sky;
}

Sky Sky::picture(const FloatImage& image, double factor, const std::string& name) {
  const std::vector<float>* channels[3] = {image.find("R"), image.find("G"), image.find("B")};
  for (size_t c = 0; c < 3; ++c)
    if (channels[c] == nullptr)
      throw Error(fmt::format("the sky has no channel {}", "RGB"[c]), name, "give one with R, G and B");
  if (!isRadiance(factor))
    throw Error(fmt::format("the factor of the sky is {:g}", factor), name, "give a number of 0 or more");
  Sky sky;
  sky.width_ = image.width;
  sky.height_ = image.height;
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  sky.pixels_.resize(width * height);
  sky.rows_.assign(height + 1, 0);
  sky.cells_.assign(height * (width + 1), 0);
  double solid_angles = 0;
  for (size_t y = 0; y < height; ++y) {
    const double area = std::cos(kPi * static_cast<double>(y) / static_cast<double>(height)) -
                        std::cos(kPi * static_cast<double>(y + 1) / static_cast<double>(height));
    double* cells = &sky.cells_[y * (width + 1)];
    for (size_t x = 0; x < width; ++x) {
      const size_t pixel = y * width + x;
      for (int c = 0; c < 3; ++c) {
        const float value = (*channels[c])[pixel];
        if (!isRadiance(static_cast<double>(value)))
          throw Error(fmt::format("the sky is {:g} at pixel {} {}", value, x, y), name,
                      "its numbers must be finite and 0 or more");
        sky.pixels_[pixel][c] = static_cast<float>(static_cast<double>(value) * factor);
      }
      const Eigen::Array3d radiance = sky.pixels_[pixel].cast<double>();
      sky.mean_ += area * radiance;
      cells[x + 1] = cells[x] + area * radiance.mean();
    }
    solid_angles += area * static_cast<double>(width);
    sky.rows_[y + 1] = sky.rows_[y] + cells[width];
  }
  sky.mean_ /= solid_angles;
  return sky;
}

Sky Sky::readPicture(const std::filesystem::path& file, double factor) {
  return picture(readExr(file), factor, file.string());
}

size_t Sky::pixelOf(const Eigen::Vector3d& direction) const {
  const double u = 0.5 + std::atan2(direction.x(), direction.z()) / (2 * kPi);
  const double v = std::acos(std::clamp(direction.y(), -1.0, 1.0)) / kPi;
  const int x = std::clamp(static_cast<int>(u * width_), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(v * height_), 0, height_ - 1);
  return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
}

double Sky::pixelPdf(size_t pixel, double sine) const {
  const auto width = static_cast<size_t>(width_);
  const double* cells = &cells_[pixel / width * (width + 1)];
  const double share = (cells[pixel % width + 1] - cells[pixel % width]) / rows_.back();
  return share * width_ * height_ / (2 * kPi * kPi * std::max(sine, 1e-9));
}

Eigen::Array3d Sky::radiance(const Eigen::Vector3d& direction) const {
  if (width_ > 0) return pixels_[pixelOf(direction)].cast<double>();
  const auto blend = static_cast<double>(kernels::f32::skyBlend(static_cast<float>(direction.y())));
  return below_ + blend * (above_ - below_);
}

Sky::Sample Sky::sample(double u, double v) const {
  if (isBlack()) return {Eigen::Vector3d::UnitY(), {0, 0, 0}, 0};
  if (width_ == 0) {
    const double height = 1 - 2 * v, radius = std::sqrt(std::max(1 - height * height, 0.0)),
                 phi = 2 * kPi * u;
    const Eigen::Vector3d direction(radius * std::cos(phi), height, radius * std::sin(phi));
    return {direction, radiance(direction), 1 / (4 * kPi)};
  }
  const auto width = static_cast<size_t>(width_);
  const SkyInterval row = skyIntervalAt(rows_.data(), static_cast<size_t>(height_), v * rows_.back());
  const double* cells = &cells_[row.index * (width + 1)];
  const SkyInterval cell = skyIntervalAt(cells, width, u * cells[width]);
  const double theta = kPi * (static_cast<double>(row.index) + row.part) / height_;
  const double phi = 2 * kPi * ((static_cast<double>(cell.index) + cell.part) / width_ - 0.5);
  const double sine = std::sin(theta);
  const size_t pixel = row.index * width + cell.index;
  return {{sine * std::sin(phi), std::cos(theta), sine * std::cos(phi)},
          pixels_[pixel].cast<double>(),
          pixelPdf(pixel, sine)};
}

double Sky::pdf(const Eigen::Vector3d& direction) const {
  if (isBlack()) return 0;
  if (width_ == 0) return 1 / (4 * kPi);
  return pixelPdf(pixelOf(direction), std::sqrt(std::max(1 - direction.y() * direction.y(), 0.0)));
}

}  // namespace strandcast
