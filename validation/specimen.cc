#include "validation/specimen.h"

#include <algorithm>
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

float anyNumber(std::mt19937& random) { return static_cast<float>(random()) / 2147483648.0f - 1; }

StrandPoints kinkedStrand(const Vec3& root, Vec3 direction, float length, int edges, float kink,
                          std::mt19937& random) {
  const float edge = length / static_cast<float>(edges);
  StrandPoints points = {root};
  for (int e = 0; e < edges; ++e) {
    points.push_back(points.back() + edge * direction);
    direction =
        (direction + kink * Vec3(anyNumber(random), anyNumber(random), anyNumber(random))).normalized();
  }
  return points;
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

StrandModel headOfHair(int strands, double length, int edges, double bend) {
  std::vector<StrandPoints> hair;
  for (int s = 0; s < strands; ++s) {
    const double y = 1 - 1.3 * (s + 0.5) / strands, r = std::sqrt(1 - y * y);
    const double angle = s * std::numbers::pi * (3 - std::sqrt(5.0));
    const Eigen::Vector3d out(r * std::cos(angle), y, r * std::sin(angle));
    StrandPoints points;
    Eigen::Vector3d at = out * static_cast<double>(kHeadRadius), way = out;
    for (int i = 0; i <= edges; ++i) {
      points.push_back(at.cast<float>());
      at += way * (length / edges);
      way = (way - bend / edges * Eigen::Vector3d::UnitY()).normalized();
    }
    hair.push_back(points);
  }
  return modelOf(hair);
}

RigidBody headBody() {
  ContactPrimitive ball;
  ball.radius = kHeadRadius - 0.002f;
  return {{ball}, true};
}

Pose shakenRoot(double time, const Shake& shake) {
  const double u = shake.ramp > 0 ? std::clamp(time / shake.ramp, 0.0, 1.0) : 1;
  const double grown = u * u * u * (10 - 15 * u + 6 * u * u);
  auto swing = [&](double hertz) { return grown * std::sin(2 * std::numbers::pi * hertz * time); };
  const double x = shake.reach * swing(shake.shakes), angle = std::numbers::pi / 4 * swing(shake.turns);
  return {Vec3(static_cast<float>(x), 0, 0),
          Quat(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitZ()))};
}

}  // namespace strandcast
