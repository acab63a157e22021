#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "gl/context.h"
#include "light/far_fibre.h"
#include "render/fibre_shader.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

constexpr std::pair<FibreFunction, const char*> kShaderFunctions[] = {
    {FibreFunction::kChiangNear, "chiang near field"},
    {FibreFunction::kChiangFar, "chiang far field"},
    {FibreFunction::kMarschner, "marschner"},
    {FibreFunction::kMarschnerElliptic, "marschner, elliptic"}};
const std::vector<double> kShaderRoughnesses{0.05, 0.3, 0.8};

std::vector<std::string> shaderNames() {
  std::vector<std::string> names{"shader: log I0", "shader: log", "shader: asin"};
  for (const double roughness : kShaderRoughnesses)
    for (const auto& [function, name] : kShaderFunctions)
      names.push_back(fmt::format("shader: {}, roughness {:g}", name, roughness));
  return names;
}

kernels::f32::real3 narrowed(const kernels::f64::real3& a) {
  return kernels::f32::makeReal3(static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z));
}

FibreConstants constantsOf(const FibreMaterial& material, const MarschnerFibre& fibre) {
  FibreConstants constants;
  constants.shape = kernels::f32::fibreShape(
      static_cast<float>(material.longitudinal_roughness), static_cast<float>(material.azimuthal_roughness),
      static_cast<float>(material.tilt), static_cast<float>(material.index));
  constants.lobes = {narrowed(fibre.lobes().shift), narrowed(fibre.lobes().width)};
  constants.size = {static_cast<float>(fibre.size().rows), static_cast<float>(fibre.size().columns), 0};
  constants.table = fibre.numbers();
  return constants;
}

/// Directions near the mirror direction, where lobes are, and anywhere.
std::vector<FibreArguments> scatteredArguments(FibreFunction function, double roughness) {
  constexpr int kItems = 4096;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<> uniform(-1, 1);
  std::vector<FibreArguments> list;
  for (int k = 0; k < kItems; ++k) {
    const double o = 1.5 * uniform(random), near = 3 * roughness * uniform(random),
                 any = 1.5 * uniform(random);
    const double i = std::clamp(k % 2 == 0 ? near - o : any, -1.55, 1.55),
                 sum = std::numbers::pi * uniform(random);
    const double phi = std::numbers::pi * uniform(random), h = uniform(random);
    list.push_back({static_cast<float>(std::sin(o)), static_cast<float>(std::cos(o)),
                    static_cast<float>(std::sin(i)), static_cast<float>(std::cos(i)), static_cast<float>(phi),
                    static_cast<float>(function == FibreFunction::kMarschnerElliptic ? std::cos(sum) : h),
                    Eigen::Array3f(0, static_cast<float>(std::abs(uniform(random))), 4)});
  }
  return list;
}

/// Largest error of the shader over the value, per channel. Values below 1e-4 of the largest count as that.
Eigen::Array3d shaderErrors(FibreFunction function, const FibreConstants& constants,
                            const std::vector<FibreArguments>& arguments) {
  const std::vector<Eigen::Array3f> found = fibreValuesByShader(function, constants, arguments);
  std::vector<Eigen::Array3d> exact;
  Eigen::Array3d largest = Eigen::Array3d::Zero(), worst = largest;
  for (const FibreArguments& a : arguments) {
    exact.push_back(fibreValue(function, constants, a));
    largest = largest.max(exact.back().abs());
  }
  for (size_t i = 0; i < exact.size(); ++i) {
    const Eigen::Array3d error =
        (found[i].cast<double>() - exact[i]).abs() / exact[i].abs().max(1e-4 * largest).max(1e-30);
    for (int c = 0; c < 3; ++c) worst[c] = worse(worst[c], error[c]);
  }
  return worst;
}

std::vector<Case> shaderCases(const Laboratory& laboratory) {
  gl::HeadlessContext context;
  std::vector<Case> cases;
  const std::vector<std::string> names = shaderNames();
  const char* quantity = "largest relative error of GLSL against C++ in double precision";
  // log I0 and log from 1e-2 to 1e5, and next to 1, where drivers' logarithms are wrong; asin from -1 to 1.
  std::vector<FibreArguments> plain;
  for (int k = 0; k < 2000; ++k) {
    const double x = k % 4 == 0 ? 1 + 0.01 * std::sin(k) : std::pow(10, 7 * (k / 2000.0) - 2);
    plain.push_back(
        {static_cast<float>(x), static_cast<float>(k / 1000.0 - 1), 0, 0, 0, 0, Eigen::Array3f::Zero()});
  }
  const FibreMaterial brown;
  const MarschnerFibre tables(brown);
  const FibreConstants any = constantsOf(brown, tables);
  const std::vector<Eigen::Array3f> values = fibreValuesByShader(FibreFunction::kFunctions, any, plain);
  Eigen::Array3d worst = Eigen::Array3d::Zero();
  for (size_t i = 0; i < plain.size(); ++i) {
    const Eigen::Array3d exact = fibreValue(FibreFunction::kFunctions, any, plain[i]);
    for (int c = 0; c < 3; ++c)  // absolute where a value is below 1
      worst[c] = worse(worst[c], std::abs(static_cast<double>(values[i][c]) - exact[c]) /
                                     std::max(std::abs(exact[c]), 1.0));
  }
  for (int c = 0; c < 3; ++c)
    cases.push_back(absoluteCase({names[cases.size()], "largest error of GLSL, relative above 1", ""},
                                 worst[c], 0, 1e-5));
  cases.back().note = "on " + context.renderer();

  for (const double roughness : kShaderRoughnesses)
    for (const auto& [function, name] : kShaderFunctions) {
      laboratory.checkStopped();
      FibreMaterial material;
      material.longitudinal_roughness = material.azimuthal_roughness = roughness;
      if (function == FibreFunction::kMarschnerElliptic) material.axis_ratio = 0.9;
      const MarschnerFibre fibre(material);
      const Eigen::Array3d errors =
          shaderErrors(function, constantsOf(material, fibre), scatteredArguments(function, roughness));
      cases.push_back(absoluteCase({names[cases.size()], quantity, ""},
                                   worse(errors[0], worse(errors[1], errors[2])), 0, 1e-4));
    }
  return cases;
}

}  // namespace

void addFibreShaderExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back({"fibres in GLSL against C++", shaderNames(), shaderCases});
}

}  // namespace strandcast
