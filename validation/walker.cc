#include "validation/walker.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <string_view>

#include "core/smooth_step.h"
#include "io/file_bytes.h"
#include "io/little_endian.h"
#include "io/skeleton.h"

namespace strandcast {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr double kSpeed = 1.4, kPathRadius = 2, kCycle = 1;  // m/s, m, s of two steps

struct Joint {
  const char* name;
  int parent;
  double x, y;  // m, at rest; z is 0
};
constexpr std::array<Joint, 11> kJoints = {{{"hips", -1, 0, 0.98},
                                            {"chest", 0, 0, 1.25},
                                            {"head", 1, 0, 1.55},
                                            {"left_arm", 1, 0.27, 1.40},
                                            {"left_hand", 3, 0.27, 1.12},
                                            {"right_arm", 1, -0.27, 1.40},
                                            {"right_hand", 5, -0.27, 1.12},
                                            {"left_leg", 0, 0.085, 0.76},
                                            {"left_foot", 7, 0.085, 0.42},
                                            {"right_leg", 0, -0.085, 0.76},
                                            {"right_foot", 9, -0.085, 0.42}}};

Placement turned(const Joint& joint, const Eigen::Matrix3d& rotation) {
  Placement out = Placement::Identity();
  out.translate(Eigen::Vector3d(joint.x, joint.y, 0));
  out.rotate(rotation);
  out.translate(Eigen::Vector3d(-joint.x, -joint.y, 0));
  return out;
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// The skin: vertical tubes with round ends that do not touch each other.
struct Tube {
  std::vector<uint8_t> joints;  // from one end to the other
  float x, from, to, radius;    // m
  std::vector<float> changes;   // m, heights at which one joint passes to the next
};
const std::vector<Tube>& tubes() {
  static const std::vector<Tube> all = {{{0, 1, 2}, 0, 0.98f, 1.70f, 0.12f, {1.25f, 1.55f}},
                                        {{4, 3}, 0.27f, 0.88f, 1.40f, 0.045f, {1.12f}},
                                        {{6, 5}, -0.27f, 0.88f, 1.40f, 0.045f, {1.12f}},
                                        {{8, 7}, 0.085f, 0.10f, 0.76f, 0.065f, {0.42f}},
                                        {{10, 9}, -0.085f, 0.10f, 0.76f, 0.065f, {0.42f}}};
  return all;
}
constexpr float kBlend = 0.06f;     // m, half the stretch over which weights change
constexpr float kSpacing = 0.025f;  // m, between rings
constexpr int kSectors = 24;

/// What the file has of the skin.
struct Skin {
  ByteWriter positions, indices, joints, weights;
  size_t vertices = 0, corners = 0;

  void addVertex(const Tube& tube, float out, float y, float turn) {
    positions.put(Vec3(tube.x + out * std::cos(turn), y, -out * std::sin(turn)));
    size_t below = 0;
    float above = 0;  // weight of the next joint
    for (size_t i = 0; i < tube.changes.size(); ++i) {
      if (y < tube.changes[i] - kBlend) break;
      below = i;
      above = smoothStep(std::clamp((y - tube.changes[i] + kBlend) / (2 * kBlend), 0.0f, 1.0f));
    }
    for (const uint8_t joint : {tube.joints[below], tube.joints[below + 1], uint8_t{0}, uint8_t{0}})
      joints.put(joint);
    for (const float weight : {1 - above, above, 0.0f, 0.0f}) weights.put(weight);
    ++vertices;
  }
  void addTriangle(size_t a, size_t b, size_t c) {
    for (const size_t corner : {a, b, c}) indices.put(static_cast<uint16_t>(corner));
    corners += 3;
  }
  void add(const Tube& tube) {
    const size_t bottom = vertices;
    std::vector<std::pair<float, float>> rings;  // height and radius
    const int cap = std::max(3, static_cast<int>(1.57f * tube.radius / kSpacing));
    const int along = static_cast<int>((tube.to - tube.from) / kSpacing);
    const auto lift = [&](int i) { return 1.5707963f * static_cast<float>(i) / static_cast<float>(cap); };
    for (int i = 1; i < cap; ++i)
      rings.emplace_back(tube.from - tube.radius * std::cos(lift(i)), tube.radius * std::sin(lift(i)));
    for (int i = 0; i <= along; ++i)
      rings.emplace_back(
          tube.from + (tube.to - tube.from) * static_cast<float>(i) / static_cast<float>(along), tube.radius);
    for (int i = cap - 1; i > 0; --i)
      rings.emplace_back(tube.to + tube.radius * std::cos(lift(i)), tube.radius * std::sin(lift(i)));
    addVertex(tube, 0, tube.from - tube.radius, 0);
    for (const auto& [y, radius] : rings)
      for (int s = 0; s < kSectors; ++s)
        addVertex(tube, radius, y, static_cast<float>(kFullTurn * s / kSectors));
    const size_t top = vertices;
    addVertex(tube, 0, tube.to + tube.radius, 0);
    const auto at = [&](size_t ring, int s) {
      return bottom + 1 + ring * kSectors + static_cast<size_t>(s % kSectors);
    };
    for (int s = 0; s < kSectors; ++s) {
      addTriangle(bottom, at(0, s + 1), at(0, s));
      for (size_t r = 0; r + 1 < rings.size(); ++r) {
        addTriangle(at(r, s), at(r, s + 1), at(r + 1, s + 1));
        addTriangle(at(r, s), at(r + 1, s + 1), at(r + 1, s));
      }
      addTriangle(top, at(rings.size() - 1, s), at(rings.size() - 1, s + 1));
    }
  }
};

/// The skin and its joints as a binary glTF 2.0 file.
std::vector<std::byte> walkerGlb() {
  using Json = nlohmann::json;
  Skin skin;
  for (const Tube& tube : tubes()) skin.add(tube);
  ByteWriter inverse_binds, buffer;
  for (const Joint& joint : kJoints)
    for (int i = 0; i < 16; ++i)  // column-major
      inverse_binds.put(i == 12   ? static_cast<float>(-joint.x)
                        : i == 13 ? static_cast<float>(-joint.y)
                                  : (i % 5 == 0 ? 1.0f : 0.0f));
  Json views = Json::array(), accessors = Json::array();
  const auto append = [&](ByteWriter& part, int type, size_t count, const char* shape) {
    const std::vector<std::byte> bytes = part.take();
    views.push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    accessors.push_back(
        {{"bufferView", views.size() - 1}, {"componentType", type}, {"count", count}, {"type", shape}});
    buffer.raw(bytes.data(), bytes.size());
    buffer.zeros((4 - buffer.size() % 4) % 4);
  };
  constexpr int kByte = 5121, kShort = 5123, kFloat = 5126;
  append(skin.positions, kFloat, skin.vertices, "VEC3");
  append(skin.joints, kByte, skin.vertices, "VEC4");
  append(skin.weights, kFloat, skin.vertices, "VEC4");
  append(skin.indices, kShort, skin.corners, "SCALAR");
  append(inverse_binds, kFloat, kJoints.size(), "MAT4");
  Json nodes = Json::array(), joints = Json::array();
  for (size_t j = 0; j < kJoints.size(); ++j) {
    const Joint& joint = kJoints[j];
    const bool is_root = joint.parent < 0;
    const Joint& parent = kJoints[static_cast<size_t>(std::max(0, joint.parent))];
    nodes.push_back(
        {{"name", joint.name},
         {"translation", {joint.x - (is_root ? 0 : parent.x), joint.y - (is_root ? 0 : parent.y), 0.0}}});
    if (!is_root) nodes[static_cast<size_t>(joint.parent)]["children"].push_back(j);
    joints.push_back(j);
  }
  nodes.push_back({{"mesh", 0}, {"skin", 0}});
  const Json attributes = {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}};
  const Json primitive = {{"attributes", attributes}, {"indices", 3}};
  const Json file = {{"asset", {{"version", "2.0"}}},
                     {"scene", 0},
                     {"scenes", Json::array({{{"nodes", {0, kJoints.size()}}}})},
                     {"nodes", nodes},
                     {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})},
                     {"skins", Json::array({{{"inverseBindMatrices", 4}, {"joints", joints}}})},
                     {"accessors", accessors},
                     {"bufferViews", views},
                     {"buffers", Json::array({{{"byteLength", buffer.size()}}})}};
  std::string text = file.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  const std::vector<std::byte> binary = buffer.take();
  ByteWriter out;
  const auto put = [&](size_t n) { out.put(static_cast<uint32_t>(n)); };
  out.raw("glTF", 4);
  put(2);
  put(12 + 8 + text.size() + 8 + binary.size());
  put(text.size());
  out.raw("JSON", 4);
  out.raw(text.data(), text.size());
  put(binary.size());
  out.raw("BIN\0", 4);
  out.raw(binary.data(), binary.size());
  return out.take();
}

/// Strands that leave the trunk above the shoulders, and fall by 20 cm.
std::string hairObj(int strands, int vertices) {
  std::string text;
  for (int s = 0; s < strands; ++s) {
    const double turn = 2.399963 * s;  // the golden angle
    const double root = 1.47 + 0.23 * (s + 0.5) / strands;
    std::string line = "l";
    for (int i = 0; i < vertices; ++i) {
      const double along = static_cast<double>(i) / (vertices - 1);
      const double out = double{tubes()[0].radius} + 0.05 * (1 - std::exp(-3 * along));
      text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", out * std::cos(turn), root - 0.2 * along * along,
                          -out * std::sin(turn));
      line += fmt::format(" {}", s * vertices + i + 1);
    }
    text += line + "\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> walkerNames() {
  std::vector<std::string> names;
  for (const Joint& joint : kJoints) names.push_back(std::string("joint:") + joint.name);
  return names;
}

std::vector<Pose> walkerAt(uint64_t time_ns) {
  const double t = 1e-9 * static_cast<double>(time_ns), phase = kFullTurn * t / kCycle;
  const double swing = std::sin(phase), way = kSpeed * t / kPathRadius;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const auto knee = [&](double of) { return 0.35 * (1 + std::sin(of)); };
  const std::array<Eigen::Matrix3d, kJoints.size()> turns = {
      about(y, 0.08 * swing),
      about(y, -0.16 * swing) * about(x, 0.05 + 0.02 * std::sin(2 * phase)),
      about(y, 0.5 * std::sin(kFullTurn * 0.3 * t)) * about(x, 0.12 * std::sin(kFullTurn * 0.5 * t)),
      about(x, 0.45 * swing),
      about(x, -0.3 + 0.15 * swing),
      about(x, -0.45 * swing),
      about(x, -0.3 - 0.15 * swing),
      about(x, -0.4 * swing),
      about(x, knee(phase - 1)),
      about(x, 0.4 * swing),
      about(x, knee(phase + 2.1415927))};
  // It faces +Z at rest and walks along the circle's tangent.
  Placement walk = Placement::Identity();
  walk.translate(
      Eigen::Vector3d(-kPathRadius * std::cos(way), 0.02 * std::cos(2 * phase), kPathRadius * std::sin(way)));
  walk.rotate(about(y, way));
  std::array<Placement, kJoints.size()> motions;
  std::vector<Pose> poses;
  for (size_t j = 0; j < kJoints.size(); ++j) {
    const Joint& joint = kJoints[j];
    motions[j] =
        (joint.parent < 0 ? walk : motions[static_cast<size_t>(joint.parent)]) * turned(joint, turns[j]);
    poses.push_back({motions[j].translation().cast<float>(),
                     Eigen::Quaterniond(motions[j].linear()).normalized().cast<float>()});
  }
  return poses;
}

void writeWalker(const std::filesystem::path& folder, int strands, int vertices) {
  writeFileBytes(folder / "walker.glb", walkerGlb());
  const std::string hair = hairObj(strands, vertices);
  writeFileBytes(folder / "hair.obj", std::as_bytes(std::span(hair)));
}

}  // namespace strandcast
