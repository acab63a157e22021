// Light from all around: constant, a blend from below to above, or a picture of the whole sphere.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/exr.h"

namespace strandcast {

/// The radiance of directions, in the unit of kernels/picture.h, and the sampling of directions by it.
/// Immutable.
class Sky {
 public:
  struct Sample {
    Eigen::Vector3d direction;  ///< unit, towards the sky
    Eigen::Array3d radiance;
    double pdf;  ///< per solid angle; 0 where the sky is black
  };

  /// No light.
  Sky() = default;
  /// The same radiance everywhere, at least 0. Throws Error on numbers that are negative or not finite.
  static Sky constant(const Eigen::Array3d& radiance);
  /// The renderer's ambient light: skyBelow() to skyAbove() of kernels/picture.h.
  static Sky ambient();
  /// An equirectangular picture with the channels R, G and B: straight up in the top row, +Z in the middle,
  /// +X to the right of it. A pixel has one radiance, `factor` times its value. `name`: of the file, for
  /// errors. Throws Error where a channel is missing, or a number is negative or not finite.
  static Sky picture(const FloatImage& image, double factor, const std::string& name);
  /// Reads such a picture. Throws Error as readExr() and picture().
  static Sky readPicture(const std::filesystem::path& file, double factor);

  Eigen::Array3d radiance(const Eigen::Vector3d& direction) const;
  /// `u`, `v`: uniform in [0, 1). Uniform over the sphere, or of a picture by its pixels' brightness.
  Sample sample(double u, double v) const;
  double pdf(const Eigen::Vector3d& direction) const;
  /// Mean radiance over the sphere, for the choice among lights.
  const Eigen::Array3d& mean() const { return mean_; }
  bool isBlack() const { return !(mean_ > 0).any(); }

 private:
  size_t pixelOf(const Eigen::Vector3d& direction) const;
  double pixelPdf(size_t pixel, double sine) const;

  Eigen::Array3d below_{0, 0, 0}, above_{0, 0, 0}, mean_{0, 0, 0};
  int width_ = 0, height_ = 0;  ///< of a picture; else 0
  std::vector<Eigen::Array3f> pixels_;
  std::vector<double> rows_;   ///< cumulative weight of the rows, from 0; height + 1
  std::vector<double> cells_;  ///< per row, cumulative weight of its pixels, from 0; height x (width + 1)
};

}  // namespace strandcast
