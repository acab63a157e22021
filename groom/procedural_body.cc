#include "groom/procedural_body.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/smooth_step.h"

namespace strandcast {
namespace {

// The shapes are in millimetres and mirrored: x is the distance from the median plane.
constexpr float kMetre = 1000.0f;

// Smooth union and subtraction with a blend `k` millimetres wide (quadratic polynomial; exact outside the
// blend).
float blend(float a, float b, float k) {
  const float h = std::max(k - std::fabs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * k * 0.25f;
}
float carve(float a, float b, float k) { return -blend(-a, b, k); }

float sphere(const Vec3& p, const Vec3& centre, float radius) { return (p - centre).norm() - radius; }

// First-order distance to an ellipsoid: exact at the surface, monotonic elsewhere.
float ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 q = (p - centre).cwiseQuotient(radii);
  const float k0 = q.norm();
  const float k1 = q.cwiseQuotient(radii).norm();
  return k1 > 1e-9f ? k0 * (k0 - 1.0f) / k1 : -radii.minCoeff();
}

// A capsule whose radius runs linearly from ra at a to rb at b.
float taper(const Vec3& p, const Vec3& a, const Vec3& b, float ra, float rb) {
  const Vec3 axis = b - a;
  const float t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0f, 1.0f);
  return (p - a - t * axis).norm() - (ra + t * (rb - ra));
}

float ellipse(float x, float y, float rx, float ry) {
  const float qx = x / rx, qy = y / ry;
  const float k0 = std::sqrt(qx * qx + qy * qy);
  const float k1 = std::sqrt(qx * qx / (rx * rx) + qy * qy / (ry * ry));
  return k1 > 1e-9f ? k0 * (k0 - 1.0f) / k1 : -std::min(rx, ry);
}

float cranium(const Vec3& p) {
  float d = ellipsoid(p, {0, 10, -6}, {74, 90, 95});
  d = blend(d, ellipsoid(p, {0, 24, 30}, {63, 62, 62}), 22);   // forehead
  d = blend(d, ellipsoid(p, {0, 20, -36}, {76, 66, 64}), 22);  // parietal bones and occiput
  return d;
}

float face(const Vec3& p, float d) {
  d = blend(d, ellipsoid(p, {0, -42, 36}, {56, 70, 50}), 20);         // maxilla
  d = blend(d, ellipsoid(p, {0, -86, 40}, {42, 36, 38}), 18);         // floor of the mouth
  d = blend(d, taper(p, {46, -52, 2}, {41, -86, 12}, 14, 11), 22);    // ramus
  d = blend(d, taper(p, {41, -87, 12}, {12, -115, 66}, 11, 12), 20);  // jaw line
  d = blend(d, ellipsoid(p, {0, -115, 71}, {18, 14, 15}), 14);        // chin
  d = blend(d, ellipsoid(p, {42, -38, 56}, {20, 14, 19}), 16);        // cheekbone
  d = blend(d, taper(p, {56, -32, 40}, {68, -22, 2}, 9, 7), 16);      // zygomatic arch
  d = blend(d, ellipsoid(p, {35, -64, 48}, {22, 30, 24}), 22);        // cheek
  d = blend(d, taper(p, {10, 6, 82}, {42, 7, 69}, 8.5f, 7), 14);      // brow ridge
  return d;
}

float eyes(const Vec3& p, float d) {
  if (sphere(p, {32, -14, 78}, 40) > 0) return d;
  d = carve(d, ellipsoid(p, {31, -13, 91}, {17, 10.5f, 15}), 13);  // socket
  const Vec3 centre(31, -15, 67);
  d = blend(d, sphere(p, centre, 14.5f), 4.5f);  // eyeball under closed lids
  // Seam of the lids: an arc over the eyeball, lower in the middle.
  const float sag = 0.012f * (p.x() - 31) * (p.x() - 31);
  const Vec3 q(p.x(), p.y() - sag + 21.5f, p.z());
  const float seam = std::hypot(q.y(), std::max(std::fabs(sphere(p, centre, 14.5f)), 0.0f)) - 1.7f;
  const float ends = 0.022f * (p.x() - 31) * (p.x() - 31);  // the seam fades out towards the corners
  return carve(d, std::max(seam + ends, 70 - p.z()), 4);
}

float nose(const Vec3& p, float d) {
  if (sphere(p, {0, -38, 92}, 52) > 0) return d;
  d = blend(d, taper(p, {0, -4, 82}, {0, -46, 102}, 6.5f, 7.5f), 11);   // bridge
  d = blend(d, ellipsoid(p, {0, -52, 95}, {11, 9, 12}), 8);             // septum
  d = blend(d, ellipsoid(p, {0, -50, 105}, {9, 8.5f, 9}), 8);           // tip
  d = blend(d, ellipsoid(p, {11.5f, -54.5f, 95}, {6.5f, 7, 9.5f}), 7);  // wing
  d = carve(d, ellipsoid(p, {6.2f, -62, 98}, {3.6f, 3.2f, 6}), 4);      // nostril
  return d;
}

float mouth(const Vec3& p, float d) {
  if (sphere(p, {0, -82, 84}, 50) > 0) return d;
  d = blend(d, ellipsoid(p, {0, -80, 66}, {30, 24, 27}), 14);          // teeth under the lips
  d = carve(d, taper(p, {0, -65, 100}, {0, -75, 98.5f}, 2, 2.8f), 5);  // philtrum
  // The lips follow the dental arch: bend the space along x.
  const Vec3 q(p.x(), p.y() - 0.002f * p.x() * p.x(), p.z() + 0.016f * p.x() * p.x());
  const float bow = 1.2f * std::exp(-q.x() * q.x() / 12);  // the dip of Cupid's bow
  d = blend(d, ellipsoid(Vec3(q.x(), q.y() + bow, q.z()), {0, -78.5f, 90}, {24, 6.5f, 8}), 4);
  d = blend(d, ellipsoid(q, {0, -89, 89}, {21, 7, 8.5f}), 4.5f);
  d = carve(d, ellipsoid(q, {0, -83.6f, 99}, {24, 1.6f, 5.5f}), 3);  // seam of the lips
  return d;
}

float ear(const Vec3& p, float d) {
  const Vec3 centre(72.5f, -23, -10);
  if (sphere(p, centre, 48) > 0) return d;
  // Frame: u backward along the ear, v up (leaning back), w outward and forward.
  static const Vec3 kOut = Vec3(0.86f, 0.06f, 0.46f).normalized();
  static const Vec3 kBack = Vec3(0.10f, 0.97f, -0.20f).cross(kOut).normalized();
  static const Vec3 kUp = kOut.cross(kBack);
  const Vec3 r = p - centre;
  const float u = r.dot(kBack) - 2.0f, v = r.dot(kUp), w = r.dot(kOut) - 3.0f;
  const float narrowing = 1.0f + 0.009f * v;  // wide above, narrow at the lobe
  const float outline = ellipse(u / narrowing, v, 14, 27);
  float plate = -blend(-outline, 2.6f - std::fabs(w + 1.5f), 3);
  const float helix = std::hypot(outline, w - 1.5f) - 3.3f;
  const float antihelix = std::hypot(ellipse(u - 1.0f, v + 1.0f, 7.5f, 16), w - 0.5f) - 2.6f;
  plate = blend(plate, u > -9 ? antihelix : antihelix + (-9 - u), 3);
  plate = blend(plate, helix, 3);
  plate = carve(plate, ellipsoid(Vec3(u, v, w), {-3, -5, 4}, {6.5f, 10, 6}), 3);     // concha
  plate = blend(plate, ellipsoid(Vec3(u, v, w), {-2, -25, 0.5f}, {8, 8.5f, 4}), 4);  // lobe
  plate = blend(plate, ellipsoid(Vec3(u, v, w), {-12, -6, 1}, {4.5f, 7, 3.6f}), 4);  // tragus
  return blend(d, plate, 5);
}

float neck(const Vec3& p, float d) {
  d = blend(d, taper(p, {0, -50, -30}, {0, -225, -46}, 49, 54), 26);
  d = blend(d, taper(p, {50, -50, -26}, {13, -226, 8}, 11, 9), 20);       // sternocleidomastoid
  d = blend(d, ellipsoid(p, {0, -148, 12}, {11, 18, 12}), 16);            // larynx
  d = blend(d, taper(p, {18, -140, -58}, {135, -246, -56}, 20, 22), 42);  // trapezius
  return d;
}

float torso(const Vec3& p) {
  float d = ellipsoid(p, {0, -345, -38}, {160, 138, 98});                 // rib cage
  d = blend(d, taper(p, {50, -262, -48}, {160, -265, -46}, 38, 36), 40);  // shoulder girdle
  d = blend(d, ellipsoid(p, {167, -292, -46}, {43, 70, 46}), 46);         // deltoid
  d = blend(d, ellipsoid(p, {64, -328, 26}, {78, 70, 36}), 44);           // pectoral
  d = blend(d, ellipsoid(p, {78, -318, -108}, {62, 78, 24}), 44);         // shoulder blade
  d = blend(d, taper(p, {15, -231, 12}, {80, -229, 2}, 7.5f, 7), 20);     // collar bone
  d = blend(d, taper(p, {80, -229, 2}, {158, -236, -36}, 7, 6), 20);
  return d;
}

// The base of the bust: a shallow bowl that rises towards the arms.
float base(const Vec3& p) { return ellipsoid(p, {0, -190, -40}, {222, 245, 180}); }

// Mirrors at the median plane, rounded over `width` so that paired shapes meet without a crease.
Vec3 mirrored(const Vec3& p, float width) { return {std::hypot(p.x(), width), p.y(), p.z()}; }

float sculpture(const Vec3& world) {
  const Vec3 p = mirrored(world, 2);
  float d = cranium(p);
  if (p.y() < 60) d = face(p, d);
  if (p.y() > 40) return d;
  d = eyes(p, d);
  d = nose(p, d);
  d = mouth(p, d);
  d = ear(p, d);
  const Vec3 q = mirrored(world, 12);
  d = neck(q, d);
  const float body = -blend(-torso(q), -base(q), 16);
  d = blend(d, body, 24);
  return carve(d, sphere(q, {0, -222, 24}, 9), 14);  // the notch between the collar bones
}

// ---- Polygonisation: dual marching cubes (Nielson 2004). A cell crossed by several sheets gets one vertex
// per sheet, so each edge of the result has two triangles.

// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2). Edge e = 4 * axis + i joins corners kEdges[e].
constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

// Sheet of each crossed edge of a cell, for one pattern of inside corners.
struct CellSheets {
  std::array<int8_t, 12> sheet;  // -1 where the edge is not crossed
  int count = 0;
};

int edgeBetween(int a, int b) {
  for (int e = 0; e < 12; ++e)
    if ((kEdges[e][0] == a && kEdges[e][1] == b) || (kEdges[e][0] == b && kEdges[e][1] == a)) return e;
  return -1;
}

CellSheets makeSheets(int inside) {
  const auto in = [&](int c) { return (inside >> c & 1) != 0; };
  std::array<int, 12> parent;
  for (int e = 0; e < 12; ++e) parent[e] = e;
  const auto find = [&](int e) {
    while (parent[e] != e) e = parent[e];
    return e;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    for (int side : {0, 1 << axis}) {
      const std::array<int, 4> ring{side, side + u, side + u + v, side + v};
      int before = -1;  // a face has two crossed edges or none: settleFaces() removes the ambiguous case
      for (int i = 0; i < 4; ++i) {
        if (in(ring[i]) == in(ring[(i + 1) % 4])) continue;
        const int edge = edgeBetween(ring[i], ring[(i + 1) % 4]);
        if (before >= 0) parent[find(before)] = find(edge);
        before = edge;
      }
    }
  }
  CellSheets sheets;
  sheets.sheet.fill(-1);
  for (int e = 0; e < 12; ++e)
    if (in(kEdges[e][0]) != in(kEdges[e][1]) && find(e) == e)
      sheets.sheet[e] = static_cast<int8_t>(sheets.count++);
  for (int e = 0; e < 12; ++e)
    if (in(kEdges[e][0]) != in(kEdges[e][1])) sheets.sheet[e] = sheets.sheet[find(e)];
  return sheets;
}

/// Calls work(i) for i in 0 .. count - 1, in any order, on all processors in parallel.
template <class Work>
void forEachAtOnce(int count, const Work& work) {
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> others;
  for (unsigned t = 1; t < std::thread::hardware_concurrency() && static_cast<int>(t) < count; ++t)
    others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
}

class Polygoniser {
 public:
  explicit Polygoniser(float cell) : cell_(cell), values_(0) {
    const Vec3 size = kHigh - kLow;
    for (int c = 0; c < 3; ++c) n_[c] = static_cast<int>(std::ceil(size[c] / cell)) + 1;
    values_.resize(static_cast<size_t>(n_[0]) * n_[1] * n_[2]);
    for (int i = 0; i < 256; ++i) sheets_[i] = makeSheets(i);
  }

  TriangleMesh run() {
    forEachAtOnce((n_[1] + kBlock - 1) / kBlock, [this](int row) {
      for (int z = 0; z < n_[2]; z += kBlock)
        for (int x = 0; x < n_[0]; x += kBlock) fill({x, row * kBlock, z}, kBlock);
    });
    settleFaces();
    placeVertices();
    joinFaces();
    return std::move(mesh_);
  }

 private:
  using Index = std::array<int, 3>;
  static constexpr int kBlock = 16;
  static inline const Vec3 kLow{-240, -460, -190}, kHigh{240, 115, 140};  // mm, holds the sculpture

  size_t at(const Index& i) const { return (static_cast<size_t>(i[2]) * n_[1] + i[1]) * n_[0] + i[0]; }
  Vec3 vertexPosition(const Index& i) const {
    return kLow + cell_ * Vec3(float(i[0]), float(i[1]), float(i[2]));
  }

  // Fills the values at the corners of a block. Far from the surface they all get the value at the block's
  // centre, for its sign. Near the surface the block is divided by eight. The smallest blocks are evaluated
  // corner by corner.
  void fill(const Index& low, int size) {
    Index high;
    for (int c = 0; c < 3; ++c) high[c] = std::min(low[c] + size, n_[c]);
    if (low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]) return;
    const float half = 0.5f * static_cast<float>(size) * cell_;
    const float middle = sculpture(vertexPosition(low) + Vec3::Constant(half));
    const bool far = std::fabs(middle) > kSafety * std::sqrt(3.0f) * (half + cell_);
    if (!far && size > 2) {
      for (int child = 0; child < 8; ++child) {
        const int s = size / 2;
        fill({low[0] + (child & 1) * s, low[1] + (child >> 1 & 1) * s, low[2] + (child >> 2) * s}, s);
      }
      return;
    }
    Index i;
    for (i[2] = low[2]; i[2] < high[2]; ++i[2])
      for (i[1] = low[1]; i[1] < high[1]; ++i[1])
        for (i[0] = low[0]; i[0] < high[0]; ++i[0])
          values_[at(i)] = far ? middle : sculpture(vertexPosition(i));
  }

  int insideMask(const Index& i) const {
    int mask = 0;
    for (int c = 0; c < 8; ++c) mask |= (values_[at(corner(i, c))] < 0) << c;
    return mask;
  }
  static Index corner(const Index& i, int c) {
    return {i[0] + (c & 1), i[1] + (c >> 1 & 1), i[2] + (c >> 2)};
  }

  // Resolves ambiguous faces. A face whose diagonal corners have equal signs can be joined in two ways, and
  // an edge with four triangles may result. The outside corner nearest to the surface becomes an inside
  // corner.
  void settleFaces() {
    for (bool changed = true; changed;) {
      changed = false;
      Index i;
      for (i[2] = 1; i[2] + 1 < n_[2]; ++i[2])
        for (i[1] = 1; i[1] + 1 < n_[1]; ++i[1])
          for (i[0] = 1; i[0] + 1 < n_[0]; ++i[0])
            for (int axis = 0; axis < 3; ++axis) changed |= settleFace(i, axis);
    }
  }
  bool settleFace(const Index& i, int axis) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const std::array<size_t, 4> ring{at(i), at(corner(i, u)), at(corner(i, u + v)), at(corner(i, v))};
    const auto in = [&](int k) { return values_[ring[k]] < 0; };
    if (in(0) == in(1) || in(0) != in(2) || in(1) != in(3)) return false;
    // Corners only ever change to inside, so the loop terminates.
    const int first = in(0) ? 1 : 0;
    const size_t chosen = values_[ring[first]] <= values_[ring[first + 2]] ? ring[first] : ring[first + 2];
    values_[chosen] = -1e-3f;
    return true;
  }

  void placeVertices() {
    std::vector<std::pair<Index, int>> vertices;  // cell and sheet
    Index i;
    for (i[2] = 0; i[2] + 1 < n_[2]; ++i[2])
      for (i[1] = 0; i[1] + 1 < n_[1]; ++i[1])
        for (i[0] = 0; i[0] + 1 < n_[0]; ++i[0]) {
          const int mask = insideMask(i);
          if (mask == 0 || mask == 255) continue;
          const CellSheets& sheets = sheets_[mask];
          first_vertex_[at(i)] = static_cast<uint32_t>(vertices.size());
          for (int s = 0; s < sheets.count; ++s) vertices.emplace_back(i, s);
        }
    mesh_.positions.resize(vertices.size());
    mesh_.normals.resize(vertices.size());
    constexpr size_t kAtOnce = 256;
    forEachAtOnce(static_cast<int>((vertices.size() + kAtOnce - 1) / kAtOnce), [&](int run) {
      const size_t first = static_cast<size_t>(run) * kAtOnce,
                   end = std::min(first + kAtOnce, vertices.size());
      for (size_t v = first; v < end; ++v)
        placeVertex(vertices[v].first, sheets_[insideMask(vertices[v].first)], vertices[v].second, v);
    });
  }

  // Places a vertex at the mean of the edge crossings, then moves it to the surface by Newton steps.
  void placeVertex(const Index& cell, const CellSheets& sheets, int sheet, size_t vertex) {
    Vec3 p = Vec3::Zero();
    float crossings = 0;
    for (int e = 0; e < 12; ++e) {
      if (sheets.sheet[e] != sheet) continue;
      const Index a = corner(cell, kEdges[e][0]), b = corner(cell, kEdges[e][1]);
      const float da = values_[at(a)], db = values_[at(b)];
      p += vertexPosition(a) + (vertexPosition(b) - vertexPosition(a)) * (da / (da - db));
      crossings += 1;
    }
    p /= crossings;
    Vec3 gradient = slope(p);
    for (int step = 0; step < 4; ++step) {
      const float d = sculpture(p);
      if (std::fabs(d) < 0.01f) break;
      if (step > 1) gradient = slope(p);  // strongly curved: the first gradient is out of date
      const float steepness = std::max(gradient.norm(), 0.2f);
      p -= gradient * (std::clamp(d / steepness, -0.4f * cell_, 0.4f * cell_) / steepness);
    }
    gradient = slope(p);
    mesh_.positions[vertex] = p / kMetre;
    mesh_.normals[vertex] = gradient.norm() > 1e-6f ? Vec3(gradient.normalized()) : Vec3(0, 1, 0);
  }
  static Vec3 slope(const Vec3& p) {
    constexpr float h = 0.4f;  // mm; gradient from the four corners of a tetrahedron
    Vec3 gradient = Vec3::Zero();
    for (const Vec3& c : {Vec3(1, -1, -1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, 1, 1)})
      gradient += c * sculpture(p + h * c);
    return gradient / (4 * h);
  }

  uint32_t vertexOf(const Index& cell, int edge) const {
    return first_vertex_.at(at(cell)) + static_cast<uint32_t>(sheets_[insideMask(cell)].sheet[edge]);
  }

  // A crossed grid edge is surrounded by four cells: two triangles.
  void joinFaces() {
    Index i;
    for (i[2] = 1; i[2] + 1 < n_[2]; ++i[2])
      for (i[1] = 1; i[1] + 1 < n_[1]; ++i[1])
        for (i[0] = 1; i[0] + 1 < n_[0]; ++i[0])
          for (int axis = 0; axis < 3; ++axis) {
            Index next = i;
            ++next[axis];
            const bool inside = values_[at(i)] < 0;
            if (inside != (values_[at(next)] < 0)) joinFace(i, axis, inside);
          }
  }
  void joinFace(const Index& i, int axis, bool inside) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<uint32_t, 4> quad;
    for (int k = 0; k < 4; ++k) {
      const int back_u = k == 0 || k == 3, back_v = k < 2;  // cells (-,-) (0,-) (0,0) (-,0) around the edge
      Index cell = i;
      cell[u] -= back_u;
      cell[v] -= back_v;
      const int low = (back_u << u) | (back_v << v);
      quad[k] = vertexOf(cell, edgeBetween(low, low | 1 << axis));
    }
    if (!inside) std::swap(quad[1], quad[3]);
    const auto& p = mesh_.positions;
    const bool first = (p[quad[0]] - p[quad[2]]).squaredNorm() <= (p[quad[1]] - p[quad[3]]).squaredNorm();
    const int s = first ? 0 : 1;
    mesh_.triangles.push_back({quad[s], quad[s + 1], quad[s + 2]});
    mesh_.triangles.push_back({quad[s], quad[s + 2], quad[(s + 3) % 4]});
  }

  // Margin for skipping blocks: the gradient of the field may exceed 1 where first-order ellipsoid distances
  // blend.
  static constexpr float kSafety = 1.5f;

  float cell_;  // mm
  Index n_{};
  std::vector<float> values_;
  std::array<CellSheets, 256> sheets_;
  std::unordered_map<size_t, uint32_t> first_vertex_;
  TriangleMesh mesh_;
};

}  // namespace

float bodyDistance(const Vec3& point) { return sculpture(point * kMetre) / kMetre; }

Vec3 bodyNormal(const Vec3& point) {
  // Gradient from the four corners of a tetrahedron.
  const Vec3 p = point * kMetre;
  constexpr float h = 0.4f;
  Vec3 gradient = Vec3::Zero();
  for (const Vec3& corner : {Vec3(1, -1, -1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, 1, 1)})
    gradient += corner * sculpture(p + h * corner);
  const float length = gradient.norm();
  return length > 1e-12f ? Vec3(gradient / length) : Vec3(0, 1, 0);
}

float scalpDensity(const Vec3& point) {
  const Vec3 p(std::fabs(point.x()) * kMetre, point.y() * kMetre, point.z() * kMetre);
  // Height of the hairline by azimuth, from the forehead (0) to the nape (180 degrees).
  struct Knot {
    float degrees, height;
  };
  static constexpr std::array<Knot, 11> kHairline{{{0, 66},
                                                   {22, 62},
                                                   {42, 54},
                                                   {56, 38},
                                                   {68, -2},
                                                   {78, -16},
                                                   {88, 10},
                                                   {108, 6},
                                                   {128, -42},
                                                   {150, -66},
                                                   {180, -72}}};
  const float angle = std::atan2(p.x(), p.z() + 5.0f) * (180.0f / std::numbers::pi_v<float>);
  float line = kHairline.back().height;
  for (size_t k = 1; k < kHairline.size(); ++k) {
    if (angle > kHairline[k].degrees) continue;
    const float t = (angle - kHairline[k - 1].degrees) / (kHairline[k].degrees - kHairline[k - 1].degrees);
    line = kHairline[k - 1].height + (kHairline[k].height - kHairline[k - 1].height) * smoothStep(t);
    break;
  }
  const auto ramp = [](float d, float width) { return smoothStep(0.5f + d / width); };
  return ramp(p.y() - line, 14) * ramp(ellipsoid(p, {83, -22, -16}, {22, 33, 22}), 6);
}

float bodyHeadWeight(const Vec3& point) {
  // The transition follows a plane tilted from the chin to the nape.
  const Vec3 p = point * kMetre;
  return smoothStep((p.y() + 0.55f * p.z() + 205.0f) / 95.0f);
}

namespace {

// Capsules fitted by simulated annealing, in millimetres: 0.2 mm or more inside the skin, and together close
// to all of it. Each capsule off the median plane stands for itself and its mirror image.
struct Capsule {
  float a[3], b[3], radius;
};
constexpr Capsule kHeadCapsules[] = {
    {{0.0f, -64.7f, 29.1f}, {0.0f, -63.7f, -14.0f}, 58.0f},
    {{0.0f, 23.4f, -4.0f}, {0.0f, 16.3f, 11.5f}, 73.2f},
    {{0.0f, -74.9f, -11.8f}, {0.0f, -3.2f, -43.7f}, 56.4f},
    {{0.0f, 22.9f, -44.8f}, {0.0f, -98.9f, -25.5f}, 49.8f},
    {{0.0f, 24.6f, 23.0f}, {0.0f, -4.9f, -28.5f}, 68.8f},
    {{0.0f, 31.6f, -17.3f}, {0.0f, 30.0f, 11.6f}, 67.7f},
    {{0.0f, -125.0f, -37.9f}, {0.0f, -135.0f, -38.4f}, 52.2f},
    {{0.0f, 21.2f, 47.3f}, {0.0f, -100.6f, -35.5f}, 48.2f},
    {{0.0f, -39.8f, -12.1f}, {0.0f, 5.4f, -38.5f}, 64.7f},
    {{0.0f, 16.9f, -26.6f}, {0.0f, 15.9f, -24.2f}, 78.6f},
    {{46.2f, 2.7f, -8.4f}, {33.4f, -44.9f, 49.7f}, 29.6f},
    {{-9.3f, -109.2f, 61.1f}, {-39.2f, 12.0f, 56.9f}, 19.0f},
};
constexpr Capsule kShoulderCapsules[] = {
    {{0.0f, -133.7f, -40.1f}, {0.0f, -355.1f, -48.8f}, 52.5f},
    {{0.0f, -259.4f, -38.5f}, {0.0f, -317.1f, -67.9f}, 70.0f},
    {{-126.0f, -295.9f, -46.7f}, {94.3f, -294.5f, -66.7f}, 64.8f},
    {{121.4f, -245.5f, -54.1f}, {8.6f, -123.5f, -60.5f}, 21.9f},
    {{52.5f, -300.1f, -45.3f}, {-62.0f, -322.2f, -23.1f}, 90.0f},
    {{158.0f, -265.6f, -46.4f}, {-6.3f, -250.6f, -59.1f}, 48.7f},
};

std::vector<ContactPrimitive> primitives(std::span<const Capsule> capsules) {
  std::vector<ContactPrimitive> out;
  for (const Capsule& capsule : capsules) {
    const bool paired = capsule.a[0] != 0 || capsule.b[0] != 0;
    for (float side : paired ? std::vector<float>{1, -1} : std::vector<float>{1}) {
      ContactPrimitive primitive;
      primitive.kind = PrimitiveKind::kCapsule;
      primitive.a = Vec3(side * capsule.a[0], capsule.a[1], capsule.a[2]) / kMetre;
      primitive.b = Vec3(side * capsule.b[0], capsule.b[1], capsule.b[2]) / kMetre;
      primitive.radius = capsule.radius / kMetre;
      out.push_back(primitive);
    }
  }
  return out;
}

}  // namespace

ProceduralBody makeProceduralBody(float cell) {
  if (!(cell >= 0.0015f && cell <= 0.01f))
    throw Error("cell is out of range", std::to_string(cell) + " m", "choose 0.0015 to 0.01 m");
  ProceduralBody body;
  body.mesh = Polygoniser(cell * kMetre).run();
  body.mesh.name = "procedural body";
  body.head = primitives(kHeadCapsules);
  body.shoulders = primitives(kShoulderCapsules);
  body.neck_pivot = Vec3(0, -0.115f, -0.025f);
  for (const Vec3& p : body.mesh.positions) body.head_weight.push_back(bodyHeadWeight(p));
  const auto moves = [&](const std::array<uint32_t, 3>& t) {
    return std::any_of(t.begin(), t.end(), [&](uint32_t v) { return body.head_weight[v] > 0; });
  };
  auto& triangles = body.mesh.triangles;
  const auto rest = std::stable_partition(triangles.begin(), triangles.end(), moves);
  body.first_static_triangle = static_cast<uint32_t>(rest - triangles.begin());
  return body;
}

}  // namespace strandcast
