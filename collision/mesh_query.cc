#include "collision/mesh_query.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "collision/mesh_repair.h"
#include "core/error.h"

namespace strandcast {
namespace {

using Point = Eigen::Vector3d;
using Triangle = std::array<Point, 3>;
// For points, axis-aligned boxes are as tight as OBBs and cheaper.
using Tree = fcl::BVHModel<fcl::AABB<double>>;

struct Closest {
  double squared = std::numeric_limits<double>::infinity();
  Point barycentric = Point::UnitX();
  int triangle = -1;
};

Point pointAt(const Triangle& t, const Point& barycentric) {
  return t[0] * barycentric[0] + t[1] * barycentric[1] + t[2] * barycentric[2];
}

Point closestOnEdge(const Triangle& t, int i, int j, const Point& p) {
  const Point edge = t[j] - t[i];
  const double squared = edge.squaredNorm();
  const double along = squared > 0 ? std::clamp((p - t[i]).dot(edge) / squared, 0.0, 1.0) : 0.0;
  Point barycentric = Point::Zero();
  barycentric[i] = 1 - along;
  barycentric[j] = along;
  return barycentric;
}

// Barycentric coordinates of the point of a triangle closest to p. A triangle without area is treated as its
// three edges.
Point closestOnTriangle(const Triangle& t, const Point& p) {
  const Point a = t[1] - t[0], b = t[2] - t[0], r = p - t[0];
  const Point normal = a.cross(b);
  const double area = normal.squaredNorm();
  if (area > 1e-24 * a.squaredNorm() * b.squaredNorm()) {
    const double v = r.cross(b).dot(normal) / area, w = a.cross(r).dot(normal) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  }
  Point best = closestOnEdge(t, 0, 1, p);
  for (int i = 1; i < 3; ++i) {
    const Point other = closestOnEdge(t, i, (i + 1) % 3, p);
    if ((pointAt(t, other) - p).squaredNorm() < (pointAt(t, best) - p).squaredNorm()) best = other;
  }
  return best;
}

// Signed solid angle of a triangle as seen from the origin (Van Oosterom and Strackee 1983).
double solidAngle(const Point& a, const Point& b, const Point& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2 * std::atan2(a.dot(b.cross(c)), denominator);
}

// Far-field moments of a subtree: the integrals of (x - centre)^m times the normal over its surface, for m =
// 0, 1, 2. They give the first three terms of the winding number's series (Barill et al. 2018, "Fast Winding
// Numbers for Soups and Clouds", section 3).
struct Moments {
  Point centre = Point::Zero();  // area-weighted
  double area = 0;
  Point normal = Point::Zero();                     // area * normal
  Eigen::Matrix3d first = Eigen::Matrix3d::Zero();  // rows: offset, columns: normal
  std::array<Eigen::Matrix3d, 3> second{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
                                        Eigen::Matrix3d::Zero()};
};

Moments ofTriangle(const Triangle& t) {
  Moments m;
  m.centre = (t[0] + t[1] + t[2]) / 3;
  m.normal = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
  m.area = m.normal.norm();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Point& corner : t) squares += (corner - m.centre) * (corner - m.centre).transpose();
  for (int k = 0; k < 3; ++k) m.second[k] = squares * (m.normal[k] / 12);
  return m;
}

// Adds the same moments about another centre to `sum`.
void add(const Moments& part, Moments& sum) {
  const Point shift = part.centre - sum.centre;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Matrix3d cross = shift * part.first.col(k).transpose();
    sum.second[k] += part.second[k] + cross + cross.transpose() + part.normal[k] * shift * shift.transpose();
  }
  sum.first += part.first + shift * part.normal.transpose();
  sum.normal += part.normal;
}

Moments joined(const Moments& a, const Moments& b) {
  Moments m;
  m.area = a.area + b.area;
  m.centre = a.centre + (m.area > 0 ? b.area / m.area : 0.5) * (b.centre - a.centre);
  add(a, m);
  add(b, m);
  return m;
}

}  // namespace

// The combinations of moments that the series needs, per node.
struct FarField {
  Eigen::Vector3f centre, normal, linear;
  Eigen::Matrix<float, 6, 1> quadratic;  // xx yy zz xy xz yz
  Eigen::Matrix<float, 10, 1> cubic;     // xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz
  float trace = 0;
  float radius = 0;  // of a ball about the centre that contains the subtree
};

namespace {

FarField farField(const Moments& m, double radius) {
  FarField f;
  f.centre = m.centre.cast<float>();
  f.normal = m.normal.cast<float>();
  f.radius = static_cast<float>(radius);
  f.trace = static_cast<float>(m.first.trace());
  Point linear;
  for (int j = 0; j < 3; ++j) {
    linear[j] = m.second[j].trace();
    for (int i = 0; i < 3; ++i) linear[j] += 2 * m.second[i](i, j);
  }
  f.linear = linear.cast<float>();
  const Eigen::Matrix3d& e = m.first;
  f.quadratic = (Eigen::Matrix<double, 6, 1>() << e(0, 0), e(1, 1), e(2, 2), e(0, 1) + e(1, 0),
                 e(0, 2) + e(2, 0), e(1, 2) + e(2, 1))
                    .finished()
                    .cast<float>();
  const auto s = [&](int i, int j, int k) { return m.second[k](i, j); };
  const auto pair = [&](int i, int j) { return s(i, i, j) + 2 * s(i, j, i); };  // coefficient of x_i^2 x_j
  f.cubic = (Eigen::Matrix<double, 10, 1>() << s(0, 0, 0), s(1, 1, 1), s(2, 2, 2), pair(0, 1), pair(0, 2),
             pair(1, 0), pair(1, 2), pair(2, 0), pair(2, 1), 2 * (s(0, 1, 2) + s(0, 2, 1) + s(1, 2, 0)))
                .finished()
                .cast<float>();
  return f;
}

// Solid angle of a far subtree. `d`: vector from the query point to its centre.
double farAngle(const FarField& f, const Eigen::Vector3f& d) {
  const float x = d.x(), y = d.y(), z = d.z();
  const float r2 = d.squaredNorm(), inverse2 = 1 / r2, inverse3 = inverse2 / std::sqrt(r2);
  const float quadratic =
      f.quadratic.dot((Eigen::Matrix<float, 6, 1>() << x * x, y * y, z * z, x * y, x * z, y * z).finished());
  const float cubic =
      f.cubic.dot((Eigen::Matrix<float, 10, 1>() << x * x * x, y * y * y, z * z * z, x * x * y, x * x * z,
                   y * y * x, y * y * z, z * z * x, z * z * y, x * y * z)
                      .finished());
  const float order2 = 7.5f * cubic * inverse2 - 1.5f * f.linear.dot(d);
  return inverse3 * (f.normal.dot(d) + f.trace - 3 * quadratic * inverse2 + order2 * inverse2);
}

// Distance, in radii of a subtree, from which it is replaced by its series. Tests require an error below
// 1e-3.
constexpr float kFar = 2.5f;

}  // namespace

struct MeshQuery::Impl {
  Tree tree;
  std::vector<FarField> far_fields;  // per node of the tree

  Triangle corners(int triangle) const {
    const fcl::Triangle& t = tree.tri_indices[triangle];
    return {tree.vertices[t[0]], tree.vertices[t[1]], tree.vertices[t[2]]};
  }

  static double squaredDistance(const fcl::AABB<double>& box, const Point& p) {
    return (p - p.cwiseMax(box.min_).cwiseMin(box.max_)).squaredNorm();
  }

  void descend(int node, const Point& p, Closest& best) const {
    const auto& bv = tree.getBV(node);
    if (bv.isLeaf()) {
      const Triangle t = corners(bv.primitiveId());
      const Point barycentric = closestOnTriangle(t, p);
      const double squared = (pointAt(t, barycentric) - p).squaredNorm();
      if (squared < best.squared) best = {squared, barycentric, bv.primitiveId()};
      return;
    }
    int near = bv.leftChild(), far = bv.rightChild();
    double near_squared = squaredDistance(tree.getBV(near).bv, p),
           far_squared = squaredDistance(tree.getBV(far).bv, p);
    if (far_squared < near_squared) {
      std::swap(near, far);
      std::swap(near_squared, far_squared);
    }
    if (near_squared < best.squared) descend(near, p, best);
    if (far_squared < best.squared) descend(far, p, best);
  }

  Moments gather(int node) {
    const auto& bv = tree.getBV(node);
    const Moments m = bv.isLeaf() ? ofTriangle(corners(bv.primitiveId()))
                                  : joined(gather(bv.leftChild()), gather(bv.rightChild()));
    const Point reach = (bv.bv.max_ - m.centre).cwiseMax(m.centre - bv.bv.min_);
    far_fields[static_cast<size_t>(node)] = farField(m, reach.norm());
    return m;
  }

  // Solid angle of a subtree, 4 pi if it surrounds p.
  double angle(int node, const Point& p) const {
    const auto& bv = tree.getBV(node);
    if (bv.isLeaf()) {
      const Triangle t = corners(bv.primitiveId());
      return solidAngle(t[0] - p, t[1] - p, t[2] - p);
    }
    const FarField& f = far_fields[static_cast<size_t>(node)];
    const Eigen::Vector3f d = f.centre - p.cast<float>();
    if (d.squaredNorm() > kFar * kFar * f.radius * f.radius) return farAngle(f, d);
    return angle(bv.leftChild(), p) + angle(bv.rightChild(), p);
  }
};

MeshQuery::MeshQuery(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  requireSoundMesh(mesh);
  std::vector<Point> points;
  points.reserve(mesh.positions.size());
  for (const Vec3& position : mesh.positions) points.emplace_back(position.cast<double>());
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  Tree& tree = impl_->tree;
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
  tree.addSubModel(points, triangles);
  if (tree.endModel() != fcl::BVH_OK)
    throw Error("no hierarchy can be built", "mesh " + mesh.name, "repair the mesh");
  impl_->far_fields.resize(static_cast<size_t>(tree.getNumBVs()));
  impl_->gather(0);
}

MeshQuery::~MeshQuery() = default;
MeshQuery::MeshQuery(MeshQuery&&) noexcept = default;

MeshPoint MeshQuery::closest(const Vec3& point) const {
  const Point p = point.cast<double>();
  Closest best;
  impl_->descend(0, p, best);
  MeshPoint out;
  if (best.triangle < 0) return out;  // the query point is not finite
  out.triangle = static_cast<uint32_t>(best.triangle);
  out.position = pointAt(impl_->corners(best.triangle), best.barycentric).cast<float>();
  out.barycentric = best.barycentric.cast<float>();
  out.distance = static_cast<float>(std::sqrt(best.squared));
  return out;
}

float MeshQuery::distance(const Vec3& point, float bound) const {
  Closest best;
  best.squared = static_cast<double>(bound) * bound;
  impl_->descend(0, point.cast<double>(), best);
  return best.triangle < 0 ? bound : static_cast<float>(std::sqrt(best.squared));
}

float MeshQuery::windingNumber(const Vec3& point) const {
  return static_cast<float>(impl_->angle(0, point.cast<double>()) / (4 * std::numbers::pi));
}

float MeshQuery::signedDistance(const Vec3& point) const {
  const float distance = closest(point).distance;
  return windingNumber(point) > 0.5f ? -distance : distance;
}

size_t MeshQuery::bytes(size_t triangles) {
  constexpr size_t kNode = sizeof(fcl::BVNode<fcl::AABB<double>>) + sizeof(FarField);
  constexpr size_t kTriangle = sizeof(fcl::Triangle) + sizeof(Point) / 2 + sizeof(unsigned);
  return triangles * (2 * kNode + 2 * kTriangle);  // input arrays exist twice while building
}

}  // namespace strandcast
