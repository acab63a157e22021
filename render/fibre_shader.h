// For tests and `strandcast validate light`: the functions of kernels/fibre.h evaluated by the device.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "kernels/scalar_fibre.h"

namespace strandcast {

enum class FibreFunction {
  kFunctions,         ///< of x and s: log I0(x), log(x), asin(s)
  kChiangNear,        ///< f cos(theta_i)
  kChiangFar,         ///< the same, by the table
  kMarschner,         ///< S
  kMarschnerElliptic  ///< the same of an elliptic fibre
};

/// Arguments of a function for one item: sines and cosines of theta_o and theta_i, phi, then h (near field)
/// or cos(2 phi_h) (elliptic), and sigma_a of three channels. kFunctions has x and s in sin_o and cos_o.
struct FibreArguments {
  float sin_o, cos_o, sin_i, cos_i, phi, across;
  Eigen::Array3f sigma;
};

/// Constants of a fibre, as the kernel takes them in single precision. `table`: [tables][rows][columns][16].
struct FibreConstants {
  kernels::f32::FibreShape shape;
  kernels::f32::MarschnerLobes lobes;
  kernels::f32::FibreTableSize size;
  std::span<const float> table;
};

/// Values by a compute shader, in the order of `arguments`. Needs a current context.
std::vector<Eigen::Array3f> fibreValuesByShader(FibreFunction function, const FibreConstants& fibre,
                                                std::span<const FibreArguments> arguments);

/// The same by the kernel in double precision.
Eigen::Array3d fibreValue(FibreFunction function, const FibreConstants& fibre,
                          const FibreArguments& arguments);

}  // namespace strandcast
