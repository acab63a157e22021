#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "core/srgb.h"
#include "gl/context.h"
#include "render/renderer.h"

namespace strandcast {

/// A test with its own headless context; skipped, with the reason, where there is none.
class OffscreenTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    if (!gl::headlessAvailable(&reason)) GTEST_SKIP() << reason;
    context_ = std::make_unique<gl::HeadlessContext>();
  }

  static RenderSettings smallPicture() {
    RenderSettings settings;
    settings.width = settings.height = 128;
    settings.growth.hairs = 1000;
    settings.segments = 16;
    return settings;
  }

 private:
  std::unique_ptr<gl::HeadlessContext> context_;
};

/// Linear value, 0 to 1, of one channel of a pixel.
inline double linearValue(const Image& image, int x, int y, int channel) {
  return linearOf(image.rgb[3 * (static_cast<size_t>(y) * image.width + x) + channel] / 255.0);
}

inline GuideFrame restFrame(const GroomDescription& groom) {
  GuideFrame frame;
  frame.positions = groom.guides.positions;
  return frame;
}

/// Vertical guides on a grid of nx by nz, from `top` downwards, `spacing` apart, m.
inline GroomDescription verticalBundle(int nx, int nz, float spacing, float top, float length, int vertices) {
  GroomDescription groom;
  for (int z = 0; z < nz; ++z) {
    for (int x = 0; x < nx; ++x) {
      std::vector<Vec3> points;
      for (int i = 0; i < vertices; ++i)
        points.emplace_back(spacing * (x - 0.5f * (nx - 1)), top - length * i / (vertices - 1),
                            spacing * (z - 0.5f * (nz - 1)));
      groom.guides.append(points);
    }
  }
  return groom;
}

}  // namespace strandcast
