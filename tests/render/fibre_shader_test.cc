#include "render/fibre_shader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gl/context.h"
#include "light/far_fibre.h"

namespace strandcast {
namespace {

// `strandcast validate light` has more functions and roughnesses.
TEST(FibreShader, FarFieldIsThatOfCpp) {
  gl::HeadlessContext context;
  const FibreMaterial material;
  const FarChiangFibre fibre(material);
  FibreConstants constants{
      kernels::f32::fibreShape(0.3f, 0.3f, 0.0349f, 1.55f), {}, {}, fibre.table().numbers()};
  constants.size = {static_cast<float>(fibre.table().rows()), static_cast<float>(fibre.table().columns()), 0};
  std::vector<FibreArguments> arguments;
  for (int k = 0; k < 500; ++k) {
    const double o = 1.4 * std::sin(1.0 * k), i = 0.2 * std::cos(3.0 * k) - o, phi = 3.1 * std::sin(7.0 * k);
    arguments.push_back({static_cast<float>(std::sin(o)), static_cast<float>(std::cos(o)),
                         static_cast<float>(std::sin(i)), static_cast<float>(std::cos(i)),
                         static_cast<float>(phi), 0, material.sigma_a.cast<float>()});
  }
  const std::vector<Eigen::Array3f> values =
      fibreValuesByShader(FibreFunction::kChiangFar, constants, arguments);
  ASSERT_EQ(values.size(), arguments.size());
  double largest = 0;
  for (size_t k = 0; k < values.size(); ++k) {
    const FibreArguments& a = arguments[k];
    const Eigen::Array3d exact = fibreValue(FibreFunction::kChiangFar, constants, a);
    EXPECT_TRUE(((values[k].cast<double>() - exact).abs() <= 1e-4 * exact.max(1e-6)).all()) << k;
    // The class, from directions, agrees with the kernel, from sines and cosines.
    const Eigen::Vector3d wo(a.sin_o, a.cos_o * std::cos(a.phi), a.cos_o * std::sin(a.phi)),
        wi(a.sin_i, a.cos_i, 0);
    EXPECT_TRUE((fibre.f(wo, wi) * std::abs(a.cos_i)).isApprox(exact, 1e-3)) << k;
    largest = std::max(largest, exact.maxCoeff());
  }
  EXPECT_GT(largest, 0.05);
}

}  // namespace
}  // namespace strandcast
