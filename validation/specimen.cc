#include "validation/specimen.h"

#include <cmath>
#include <numbers>

namespace strandcast {

StrandPoints straightStrand(double length, int edges, const Vec3& direction) {
  StrandPoints points;
  for (int i = 0; i <= edges; ++i) points.push_back(direction * static_cast<float>(length * i / edges));
  return points;
}

StrandPoints helixStrand(double radius, double pitch, double length, int edges) {
  const double rise = pitch / (2 * std::numbers::pi);
  const double turn = length / std::hypot(radius, rise);
  StrandPoints points;
  for (int i = 0; i <= edges; ++i) {
    const double angle = turn * i / edges;
    points.push_back(Eigen::Vector3d(radius * (1 - std::cos(angle)), -rise * angle, radius * std::sin(angle))
                         .cast<float>());
  }
  return points;
}

StrandPoints arcStrand(double curvature, double length, int edges) {
  StrandPoints points;
  for (int i = 0; i <= edges; ++i) {
    const double angle = curvature * length * i / edges;
    points.push_back(Eigen::Vector3d(1 - std::cos(angle), -std::sin(angle), 0).cast<float>() /
                     static_cast<float>(curvature));
  }
  return points;
}

double bendingOverMass(const Material& material) {
  const double radius = material.radius;
  return material.youngs_modulus * radius * radius / (4 * material.density);
}

double lengthOfGamma(double gamma, const Material& material) {
  return std::cbrt(gamma * bendingOverMass(material) / kGravity);
}

StrandModel modelOf(const std::vector<StrandPoints>& strands, const std::vector<Material>& materials) {
  StrandSet set;
  for (const StrandPoints& points : strands) {
    set.append(points);
    set.parts.push_back(static_cast<uint16_t>(set.parts.size()));
  }
  return makeStrandModel(set, materials);
}

StrandModel modelOf(const std::vector<StrandPoints>& strands, const Material& material) {
  return modelOf(strands, std::vector<Material>{material});
}

}  // namespace strandcast
