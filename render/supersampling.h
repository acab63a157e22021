#pragma once
#include "gl/program.h"
#include "render/framebuffer.h"

namespace strandcast {

/// Filter weights around a pixel's centre, in output pixels. kBox: one pixel. kTent: two pixels. kGaussian:
/// standard deviation 0.5, cut at 1.5. kMitchell: the cubic of Mitchell and Netravali (1988) with B = C =
/// 1/3, which reaches 2 and is the sharpest.
enum class PixelFilter { kBox, kTent, kGaussian, kMitchell };

/// Reduces a picture that is `factor` times as large per side, in linear light.
class Supersampling {
 public:
  /// `width`, `height`: of the output, pixels. `factor`: 2 to 4. Throws Error.
  Supersampling(int width, int height, int factor, PixelFilter filter);
  ~Supersampling();
  Supersampling(const Supersampling&) = delete;
  Supersampling& operator=(const Supersampling&) = delete;

  /// Filters the texture `large` into texture().
  void draw(GLuint large) const;
  const Texture& texture() const { return texture_; }
  const Framebuffer& framebuffer() const { return target_; }

 private:
  int width_, height_;
  gl::Program program_;
  Texture texture_;
  Framebuffer target_;
  GLuint empty_vertices_ = 0;
};

/// The weight of a sample `x` pixels from the centre along one axis; not normalised.
float filterWeight(PixelFilter filter, float x);
/// Radius of the filter, pixels.
float filterReach(PixelFilter filter);

}  // namespace strandcast
