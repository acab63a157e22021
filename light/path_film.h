// What a path tracer accumulates per pixel, and the pictures made of it.
#pragma once
#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/exr.h"
#include "io/image.h"

namespace strandcast {

/// One path's share of a pixel. Radiance is in the unit of kernels/picture.h.
struct PathSample {
  Eigen::Array3d seen{0, 0, 0};      ///< of what is behind everything: backdrop or sky
  Eigen::Array3d single{0, 0, 0};    ///< scattered once between light and eye
  Eigen::Array3d multiple{0, 0, 0};  ///< scattered more often
  double depth = 0;                  ///< m along the view axis, of what the eye meets; 0: nothing
  bool hair = false;                 ///< the eye meets hair
};

/// Sums over the samples of every pixel. Pixels may have different numbers of samples. Different pixels may
/// be changed by different threads.
class PathFilm {
 public:
  PathFilm(int width, int height) : width_(width), height_(height), pixels_(size()) {}

  int width() const { return width_; }
  int height() const { return height_; }
  size_t size() const { return static_cast<size_t>(width_) * static_cast<size_t>(height_); }
  uint32_t samples(size_t pixel) const { return pixels_[pixel].samples; }
  uint64_t allSamples() const;

  /// Adds the next sample of a pixel: those of even number to one half-buffer, the others to the other.
  void add(size_t pixel, const PathSample& sample);
  /// Mean radiance of a pixel; 0 before its first sample.
  Eigen::Array3d radiance(size_t pixel) const;
  /// Standard error of pixels over the mean radiance, from the difference of the half-buffers: root mean
  /// square over pixels where the eye meets hair or a surface, and over the channels. Infinite before the
  /// second sample.
  double relativeError() const;

  /// The channels R G B, single.* and multiple.* (radiance), Z (m; infinite where the eye meets nothing),
  /// hair (fraction of the samples that meet hair) and spp (samples).
  FloatImage image() const;
  /// The tone mapped picture. `gains`: exposure and white balance per channel.
  Image developed(const Eigen::Array3f& gains) const;

  /// Writes all sums. `content`: identifies scene and settings. `goal`: samples per pixel of the pass in
  /// progress. Throws Error.
  void save(const std::filesystem::path& file, uint64_t content, uint32_t goal) const;
  /// Restores what save() wrote and returns its goal. Throws Error where the file cannot be read or is of
  /// another content or size.
  uint32_t restore(const std::filesystem::path& file, uint64_t content);

 private:
  struct Pixel {
    double halves[2][3], single[3], multiple[3], depth;
    uint32_t samples, hits, hair, unused;
  };

  int width_, height_;
  std::vector<Pixel> pixels_;
};

}  // namespace strandcast
