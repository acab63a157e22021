#include "render/fibre_shader.h"

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

namespace f64 = kernels::f64;

Vec3 asVec3(const kernels::f32::real3& a) { return {a.x, a.y, a.z}; }
f64::real3 inDouble(const kernels::f32::real3& a) { return f64::makeReal3(a.x, a.y, a.z); }

}  // namespace

std::vector<Eigen::Array3f> fibreValuesByShader(FibreFunction function, const FibreConstants& fibre,
                                                std::span<const FibreArguments> arguments) {
  constexpr size_t kInputs = 9, kGroup = 64;
  const size_t count = arguments.size();
  std::vector<float> inputs(kInputs * count);
  for (size_t i = 0; i < count; ++i) {
    const FibreArguments& a = arguments[i];
    const float list[kInputs] = {a.sin_o,  a.cos_o,    a.sin_i,    a.cos_i,   a.phi,
                                 a.across, a.sigma[0], a.sigma[1], a.sigma[2]};
    for (size_t k = 0; k < kInputs; ++k) inputs[k * count + i] = list[k];
  }
  const gl::Program program("fibre_values.comp", {{GL_COMPUTE_SHADER, shaders::kFibreValuesComp}});
  const gl::Buffer table(fibre.table), given(std::span<const float>{inputs});
  const gl::Buffer results(3 * count * sizeof(float), nullptr, GL_DYNAMIC_STORAGE_BIT);
  table.bindStorage(0);
  given.bindStorage(1);
  results.bindStorage(2);
  program.set("count", static_cast<int>(count));
  program.set("kind", static_cast<int>(function));
  program.set("variance", fibre.shape.variance);
  program.set("scale", fibre.shape.scale);
  program.set("index", fibre.shape.index);
  program.set("rows", fibre.size.rows);
  program.set("columns", fibre.size.columns);
  program.set("tilt_sin", asVec3(fibre.shape.tilt_sin));
  program.set("tilt_cos", asVec3(fibre.shape.tilt_cos));
  program.set("shift", asVec3(fibre.lobes.shift));
  program.set("width", asVec3(fibre.lobes.width));
  program.use();
  glDispatchCompute(static_cast<GLuint>((count + kGroup - 1) / kGroup), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<float> numbers(3 * count);
  glGetNamedBufferSubData(results.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                          numbers.data());
  std::vector<Eigen::Array3f> values(count);
  for (size_t i = 0; i < count; ++i) values[i] = {numbers[i], numbers[count + i], numbers[2 * count + i]};
  return values;
}

Eigen::Array3d fibreValue(FibreFunction function, const FibreConstants& fibre,
                          const FibreArguments& arguments) {
  const FibreArguments& a = arguments;
  const f64::FibreShape shape{fibre.shape.variance, fibre.shape.scale, fibre.shape.index,
                              inDouble(fibre.shape.tilt_sin), inDouble(fibre.shape.tilt_cos)};
  const f64::MarschnerLobes lobes{inDouble(fibre.lobes.shift), inDouble(fibre.lobes.width)};
  const f64::FibreTableSize size{fibre.size.rows, fibre.size.columns, fibre.size.first};
  const f64::real3 sigma = f64::makeReal3(a.sigma[0], a.sigma[1], a.sigma[2]);
  const float* table = fibre.table.data();
  auto asArray3d = [](const f64::real3& v) { return Eigen::Array3d(v.x, v.y, v.z); };
  switch (function) {
    case FibreFunction::kFunctions:
      return {f64::logBesselI0(a.sin_o), f64::fibreLog(a.sin_o), f64::fibreAsin(a.cos_o)};
    case FibreFunction::kChiangNear: {
      const f64::FibreRay ray = f64::fibreRay(a.sin_o, a.cos_o, a.across, shape.index);
      const f64::FibreLobes densities =
          f64::fibreDensities(shape, ray, a.sin_o, a.cos_o, a.sin_i, a.cos_i, a.phi);
      Eigen::Array3d value;
      for (int c = 0; c < 3; ++c)
        value[c] =
            fibreSum(f64::fibreShares(ray.fresnel, f64::exp(-static_cast<double>(a.sigma[c]) * ray.passage)),
                     densities);
      return value;
    }
    case FibreFunction::kChiangFar:
      return asArray3d(
          f64::chiangFarField(table, size, shape, a.sin_o, a.cos_o, a.sin_i, a.cos_i, a.phi, sigma));
    case FibreFunction::kMarschner:
      return asArray3d(
          f64::marschnerFarField(table, size, lobes, a.sin_o, a.cos_o, a.sin_i, a.cos_i, a.phi, sigma));
    case FibreFunction::kMarschnerElliptic:
      return asArray3d(f64::marschnerEllipticFarField(table, size, lobes, a.sin_o, a.cos_o, a.sin_i, a.cos_i,
                                                      a.phi, a.across, sigma));
  }
  return Eigen::Array3d::Zero();
}

}  // namespace strandcast
