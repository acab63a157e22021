#include "light/far_fibre.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "light/fibre_direction.h"

namespace strandcast {
namespace {

kernels::f64::real3 asReal3(const Eigen::Array3d& a) { return kernels::f64::makeReal3(a[0], a[1], a[2]); }
Eigen::Array3d asArray(const kernels::f64::real3& a) { return {a.x, a.y, a.z}; }

/// Rows and columns of each of an elliptic fibre's tables: 979 KB together.
constexpr int kEllipticRows = 30, kEllipticColumns = 85;
constexpr int kEllipticTables = 5;

/// Index by which TRT bends at cos(2 phi_h): Marschner et al. 2003, 5.2.3, with the ratio of the axes such
/// that it is greatest along the major axis. Ray optics confirms that and refutes the opposite.
double ellipticIndex(double index, double axis_ratio, double cos_2phi_h) {
  const double a2 = axis_ratio * axis_ratio;
  const double along = 2 * (index - 1) / a2 - index + 2, aside = 2 * (index - 1) * a2 - index + 2;
  return std::clamp(0.5 * (along + aside + cos_2phi_h * (along - aside)), 1.0, 2.5);
}

}  // namespace

FarChiangFibre::FarChiangFibre(const FibreMaterial& material)
    : FarChiangFibre(material,
                     (checkFibreMaterial(material, "material of a fibre"),
                      std::make_shared<const FibreTable>(material.azimuthal_roughness, material.index))) {}

FarChiangFibre::FarChiangFibre(const FibreMaterial& material, std::shared_ptr<const FibreTable> table)
    : material_(material), shape_(fibreShapeOf(material)), table_(std::move(table)) {}

Eigen::Array3d FarChiangFibre::f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const {
  const FibreDirection o(wo), i(wi);
  return asArray(kernels::f64::chiangFarField(table_->numbers().data(), table_->size(), shape_, o.sine,
                                              o.cosine, i.sine, i.cosine, azimuthBetween(o, i),
                                              asReal3(material_.sigma_a))) /
         std::max(i.cosine, kLeastCosine);
}

kernels::f64::MarschnerLobes marschnerLobes(const FibreMaterial& material) {
  // The variance of Chiang's model is that of theta_i + theta_o = 2 theta_h.
  const double width = 0.5 * std::sqrt(kernels::f64::longitudinalVariance(material.longitudinal_roughness));
  return {asReal3(material.tilt * Eigen::Array3d(-1, 0.5, 1.5)), asReal3(width * Eigen::Array3d(1, 0.5, 2))};
}

MarschnerFibre::MarschnerFibre(const FibreMaterial& material)
    : MarschnerFibre(material, marschnerLobes(material)) {}

MarschnerFibre::MarschnerFibre(const FibreMaterial& material, const kernels::f64::MarschnerLobes& lobes)
    : material_(material), lobes_(lobes) {
  checkFibreMaterial(material, "material of a fibre");
  const Eigen::Array3d shift = asArray(lobes.shift), width = asArray(lobes.width);
  if (!(shift.abs() <= 1.5708).all() || !(width >= 1e-4).all() || !(width <= 10).all())
    throw Error("shift or width of a lobe is out of range", "Marschner's model of a fibre",
                "give shifts from -1.57 to 1.57 rad and widths from 0.0001 to 10 rad");
  const bool round = material.axis_ratio == 1;
  const int rows = round ? FibreTable::kRows : kEllipticRows;
  const int columns = round ? FibreTable::kColumns : kEllipticColumns;
  size_ = {static_cast<double>(rows), static_cast<double>(columns), 0};
  auto append = [&](double bending_index) {
    const FibreTable table(material.azimuthal_roughness, material.index, rows, columns, bending_index);
    numbers_.insert(numbers_.end(), table.numbers().begin(), table.numbers().end());
  };
  append(material.index);
  for (int k = 0; k < kEllipticTables && !round; ++k)
    append(ellipticIndex(material.index, material.axis_ratio, 0.5 * k - 1));
}

Eigen::Array3d MarschnerFibre::f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const {
  const FibreDirection o(wo), i(wi);
  const double phi = azimuthBetween(o, i);
  const kernels::f64::real3 sigma = asReal3(material_.sigma_a);
  if (material_.axis_ratio == 1)
    return asArray(kernels::f64::marschnerFarField(numbers_.data(), size_, lobes_, o.sine, o.cosine, i.sine,
                                                   i.cosine, phi, sigma));
  const double cos_2phi_h = o.y * i.y - o.z * i.z;  // the cosine of phi_i + phi_o
  return asArray(kernels::f64::marschnerEllipticFarField(numbers_.data(), size_, lobes_, o.sine, o.cosine,
                                                         i.sine, i.cosine, phi, cos_2phi_h, sigma));
}

}  // namespace strandcast
