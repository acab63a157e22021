#include "tests/io/skinned_arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/smooth_step.h"
#include "io/little_endian.h"
#include "tests/io/sample_files.h"

namespace strandcast::samples {
namespace {

float lengthOf(const ArmOptions& o) { return o.bone * static_cast<float>(o.joints.size()); }

struct Ring {
  float y, radius;
};

/// From the bottom of the lower cap to the top of the upper one, without the poles.
std::vector<Ring> ringsOf(const ArmOptions& o) {
  const int cap = std::max(2, static_cast<int>(std::numbers::pi_v<float> / 2 * o.radius / o.spacing));
  const int along = std::max(2, static_cast<int>(lengthOf(o) / o.spacing));
  std::vector<Ring> rings;
  const auto turn = [&](int i) {
    return std::numbers::pi_v<float> / 2 * static_cast<float>(i) / static_cast<float>(cap);
  };
  for (int i = 1; i < cap; ++i)
    rings.push_back({-o.radius * std::cos(turn(i)), o.radius * std::sin(turn(i))});
  for (int i = 0; i <= along; ++i)
    rings.push_back({lengthOf(o) * static_cast<float>(i) / static_cast<float>(along), o.radius});
  for (int i = cap - 1; i > 0; --i)
    rings.push_back({lengthOf(o) + o.radius * std::cos(turn(i)), o.radius * std::sin(turn(i))});
  return rings;
}

struct Arm {
  std::vector<Vec3> positions;
  std::vector<uint16_t> indices;
};

Arm arm(const ArmOptions& o) {
  Arm out;
  const std::vector<Ring> rings = ringsOf(o);
  const int n = o.sectors;
  const auto at = [&](size_t ring, int sector) {
    return static_cast<uint16_t>(1 + static_cast<int>(ring) * n + sector % n);
  };
  out.positions.emplace_back(0, -o.radius, 0);
  for (const Ring& ring : rings)
    for (int s = 0; s < n; ++s) {
      const float turn = 2 * std::numbers::pi_v<float> * static_cast<float>(s) / static_cast<float>(n);
      out.positions.emplace_back(ring.radius * std::cos(turn), ring.y, -ring.radius * std::sin(turn));
    }
  const auto top = static_cast<uint16_t>(out.positions.size());
  out.positions.emplace_back(0, lengthOf(o) + o.radius, 0);
  for (int s = 0; s < n; ++s) {
    out.indices.insert(out.indices.end(), {0, at(0, s + 1), at(0, s)});
    for (size_t r = 0; r + 1 < rings.size(); ++r)
      out.indices.insert(out.indices.end(), {at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r, s),
                                             at(r + 1, s + 1), at(r + 1, s)});
    out.indices.insert(out.indices.end(), {top, at(rings.size() - 1, s), at(rings.size() - 1, s + 1)});
  }
  return out;
}

/// The joint below `y`, and the share of the joint above.
std::pair<size_t, float> shareAt(const ArmOptions& o, float y) {
  const auto last = static_cast<float>(o.joints.size() - 1);
  const float nearest = std::clamp(std::round(y / o.bone), 1.0f, std::max(last, 1.0f));
  const float share = smoothStep((y - nearest * o.bone + o.blend) / (2 * o.blend));
  return {static_cast<size_t>(nearest) - 1, share};
}

class Asset {
 public:
  explicit Asset(const ArmOptions& o) : o_(o) {
    const Arm made = arm(o);
    for (const Vec3& p : made.positions) bytes_.put(p);
    const size_t positions = close("34962");
    for (const uint16_t index : made.indices) bytes_.put(index);
    const size_t indices = close("34963");
    for (const Vec3& p : made.positions) {
      const auto below = static_cast<uint8_t>(shareAt(o, p.y()).first);
      for (const uint8_t joint : {below, static_cast<uint8_t>(below + 1), uint8_t{0}, uint8_t{0}})
        bytes_.put(joint);
    }
    const size_t joints = close("34962");
    for (const Vec3& p : made.positions) {
      const float share = shareAt(o, p.y()).second;
      for (const float weight : {1 - share, share, 0.0f, 0.0f})
        if (o.narrow_weights)
          bytes_.put(static_cast<uint8_t>(std::lround(255 * weight)));
        else
          bytes_.put(weight);
    }
    const size_t weights = close("34962");
    for (size_t j = 0; j < o.joints.size(); ++j)
      for (int c = 0; c < 16; ++c)
        bytes_.put(c == 13 ? -o.bone * static_cast<float>(j) : c % 5 == 0 ? 1.0f : 0.0f);
    const size_t inverse = close();
    for (int key = 0; key < 3; ++key) bytes_.put(o.seconds * static_cast<float>(key));
    const size_t times = close();
    for (int key = 0; key < 3; ++key) {
      const float half = key == 1 ? o.degrees * std::numbers::pi_v<float> / 360 : 0.0f;
      const bool cubic = o.interpolation == "CUBICSPLINE";
      if (cubic) bytes_.zeros(16);
      for (const float c : {0.0f, 0.0f, std::sin(half), std::cos(half)}) bytes_.put(c);
      if (cubic) bytes_.zeros(16);
    }
    const size_t turns = close();
    const size_t bulge = o.bulge != 0 ? putBulge(made) : 0, weights_over_time = bulge + 1;
    while (bytes_.size() % 12 != 0) bytes_.zeros(1);  // for base64, and for the alignment of the binary chunk
    bytes_total_ = bytes_.size();

    accessor(positions, 5126, made.positions.size(), "VEC3");
    accessor(indices, 5123, made.indices.size(), "SCALAR");
    accessor(joints, 5121, made.positions.size(), "VEC4");
    accessor(weights, o.narrow_weights ? 5121 : 5126, made.positions.size(), "VEC4", o.narrow_weights);
    accessor(inverse, 5126, o.joints.size(), "MAT4");
    accessor(times, 5126, 3, "SCALAR");
    accessor(turns, 5126, o.interpolation == "CUBICSPLINE" ? 9 : 3, "VEC4");
    if (o.bulge == 0) return;
    accessor(bulge, 5126, made.positions.size(), "VEC3");
    accessor(weights_over_time, 5126, o.interpolation == "CUBICSPLINE" ? 9 : 3, "SCALAR");
  }

  std::string json(const std::string& uri) const {
    std::string nodes, joints, channels;
    for (size_t j = 0; j < o_.joints.size(); ++j) {
      nodes += fmt::format(R"({{"name":"{}","translation":[0,{},0]{}}},)", o_.joints[j], j == 0 ? 0 : o_.bone,
                           j + 1 < o_.joints.size() ? fmt::format(R"(,"children":[{}])", j + 1) : "");
      joints += fmt::format("{}{}", j == 0 ? "" : ",", j);
      if (j > 0)
        channels += fmt::format(R"({}{{"sampler":0,"target":{{"node":{},"path":"rotation"}}}})",
                                j == 1 ? "" : ",", j);
    }
    const size_t mesh_node = o_.joints.size();
    return R"({"asset":{"version":"2.0"},"scene":0,)" +
           fmt::format(R"("scenes":[{{"nodes":[0,{}]}}],"nodes":[{}{{"mesh":0{}}}],)", mesh_node, nodes,
                       o_.skinned ? R"(,"skin":0)" : R"(,"name":"figure")") +
           R"("meshes":[{"primitives":[{"attributes":)" +
           R"({"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1)" + target() + "}]" + targetWeights() +
           "}]," + fmt::format(R"("skins":[{{"inverseBindMatrices":4,"joints":[{}]}}],)", joints) +
           fmt::format(R"("animations":[{{"name":"bend","channels":[{}],)", channels) +
           fmt::format(R"("samplers":[{{"input":5,"output":6,"interpolation":"{}"}}]}}{}],)",
                       o_.interpolation, swell()) +
           fmt::format(R"("accessors":[{}],"bufferViews":[{}],)", accessors_, views_) +
           fmt::format(R"("buffers":[{{"byteLength":{}{}}}]}})", bytes_total_,
                       uri.empty() ? "" : R"(,"uri":")" + uri + "\"");
  }
  Bytes take() { return bytes_.take(); }

 private:
  /// Writes two views: the target, and its weight over time.
  size_t putBulge(const Arm& made) {
    for (const Vec3& p : made.positions) bytes_.put(bulgeAt(o_, p));
    const size_t bulge = close();
    const bool cubic = o_.interpolation == "CUBICSPLINE";
    for (const float weight : {0.0f, 1.0f, 0.0f}) {
      if (cubic) bytes_.put(0.0f);
      bytes_.put(weight);
      if (cubic) bytes_.put(0.0f);
    }
    close();
    return bulge;
  }
  std::string target() const { return o_.bulge == 0 ? "" : R"(,"targets":[{"POSITION":7}])"; }
  std::string targetWeights() const {
    if (o_.bulge == 0) return "";
    return fmt::format(R"(,"weights":[{}],"extras":{{"targetNames":["bulge"]}})", o_.bulge_at_rest);
  }
  std::string swell() const {
    if (o_.bulge == 0) return "";
    return fmt::format(
               R"(,{{"name":"swell","channels":[{{"sampler":0,"target":{{"node":{},"path":"weights"}}}}],)",
               o_.joints.size()) +
           fmt::format(R"("samplers":[{{"input":5,"output":8,"interpolation":"{}"}}]}})", o_.interpolation);
  }
  /// Ends a view and returns its index.
  size_t close(const std::string& target = "") {
    while (bytes_.size() % 4 != 0) bytes_.zeros(1);
    views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", views_.empty() ? "" : ",",
                          begun_, bytes_.size() - begun_, target.empty() ? "" : ",\"target\":" + target);
    begun_ = bytes_.size();
    return view_count_++;
  }
  void accessor(size_t view, int type, size_t count, const char* shape, bool normalized = false) {
    accessors_ += fmt::format(R"({}{{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                              accessors_.empty() ? "" : ",", view, type, count, shape,
                              normalized ? R"(,"normalized":true)" : "");
  }

  const ArmOptions& o_;
  ByteWriter bytes_;
  std::string views_, accessors_;
  size_t begun_ = 0, view_count_ = 0, bytes_total_ = 0;
};

std::string gltfText(const ArmOptions& options) {
  Asset asset(options);
  // The JSON needs the buffer's length, which is known before the buffer is taken.
  const std::string head = asset.json("@");
  std::string text = head;
  text.replace(text.rfind('@'), 1, "data:application/octet-stream;base64," + base64(asset.take()));
  return text;
}

}  // namespace

ArmOptions smallArm() {
  ArmOptions options;
  options.joints = {"neck", "head"};
  options.sectors = 4;
  options.spacing = 0.2f;
  return options;
}

Vec3 bulgeAt(const ArmOptions& o, const Vec3& p) {
  const Vec3 from(p.x() - o.radius, p.y() - (lengthOf(o) - 0.5f * o.bone), p.z());
  const float near = 1 - smoothStep(from.norm() / (1.5f * o.radius));
  return {o.bulge * near, 0, 0};
}

Bytes armGlb(const ArmOptions& options) {
  Asset asset(options);
  std::string text = asset.json("");
  while (text.size() % 4 != 0) text += ' ';
  const Bytes buffer = asset.take();
  ByteWriter writer;
  writer.raw("glTF", 4);
  writer.put(uint32_t{2});
  writer.put(static_cast<uint32_t>(12 + 8 + text.size() + 8 + buffer.size()));
  writer.put(static_cast<uint32_t>(text.size()));
  writer.raw("JSON", 4);
  writer.raw(text.data(), text.size());
  writer.put(static_cast<uint32_t>(buffer.size()));
  writer.raw("BIN\0", 4);
  writer.raw(buffer.data(), buffer.size());
  return writer.take();
}

Bytes armGltf(const ArmOptions& options) { return fromText(gltfText(options)); }

Bytes armWith(const ArmOptions& options, const std::string& from, const std::string& to) {
  std::string text = gltfText(options);
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the sample has no " + from);
  return fromText(text.replace(at, from.size(), to));
}

}  // namespace strandcast::samples
