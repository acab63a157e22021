#pragma once
#include "gl/program.h"
#include "render/framebuffer.h"

namespace strandcast {

/// Weights of the samples about a pixel's middle, in pixels of the picture that comes out: a square of one
/// pixel; a tent of two; a Gaussian of standard deviation 0.5, cut at 1.5; or Mitchell and Netravali's (1988)
/// cubic with B = C = 1/3, which reaches 2 and is the sharpest.
enum class PixelFilter { kBox, kTent, kGaussian, kMitchell };

/// Makes a picture out of one that is `factor` times as large, in linear light.
class Supersampling {
 public:
  Supersampling(int width, int height, int factor, PixelFilter filter);
  ~Supersampling();
  Supersampling(const Supersampling&) = delete;
  Supersampling& operator=(const Supersampling&) = delete;

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

/// The weight of a sample `x` pixels from the middle, along one axis; not normalised.
float filterWeight(PixelFilter filter, float x);
/// How far that reaches, pixels.
float filterReach(PixelFilter filter);

}  // namespace strandcast
