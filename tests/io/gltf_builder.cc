#include "tests/io/gltf_builder.h"

#include <fmt/format.h>

#include "tests/io/sample_files.h"

namespace strandcast::samples {

size_t GltfBuilder::addView(const std::vector<std::byte>& bytes, const std::string& more) {
  while (bytes_.size() % 4 != 0) bytes_.push_back({});
  views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", views_.empty() ? "" : ",",
                        bytes_.size(), bytes.size(), more);
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return view_count_++;
}

size_t GltfBuilder::accessor(const std::string& members) {
  accessors_ += fmt::format("{}{{{}}}", accessors_.empty() ? "" : ",", members);
  return accessor_count_++;
}

size_t GltfBuilder::floats(const std::vector<float>& values, const std::string& type) {
  const size_t each = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
  return accessor(fmt::format(R"("bufferView":{},"componentType":5126,"count":{},"type":"{}")", view(values),
                              values.size() / each, type));
}

size_t GltfBuilder::points(const std::vector<Vec3>& points) {
  std::vector<float> values;
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return floats(values, "VEC3");
}

size_t GltfBuilder::indices(const std::vector<uint16_t>& values) {
  return accessor(fmt::format(R"("bufferView":{},"componentType":5123,"count":{},"type":"SCALAR")",
                              view(values), values.size()));
}

Bytes GltfBuilder::gltf(const std::string& members) const {
  Bytes padded = bytes_;
  while (padded.size() % 3 != 0) padded.push_back({});
  return fromText(fmt::format(R"({{"asset":{{"version":"2.0"}},{},"accessors":[{}],"bufferViews":[{}],)",
                              members, accessors_, views_) +
                  fmt::format(R"("buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]}})", padded.size(),
                              base64(padded)));
}

Bytes GltfBuilder::body(const std::string& primitive, const std::string& more) const {
  return gltf(fmt::format(R"("nodes":[{{"mesh":0,"name":"head"}}],"meshes":[{{"primitives":[{{{}}}]}}]{}{})",
                          primitive, more.empty() ? "" : ",", more));
}

Bytes gltfOfAllKinds() {
  GltfBuilder builder;
  const size_t bytes =
      builder.view<int8_t>({0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0}, R"(,"byteStride":4)");
  const size_t at = builder.view<uint8_t>({3}), to = builder.view<int8_t>({0, 0, 99, 0}),
               by = builder.view<float>({0, 0, 1});
  const std::string sparse = R"(,"sparse":{{"count":1,"indices":{{"bufferView":{},"componentType":5121}},)"
                             R"("values":{{"bufferView":{}}}}})";
  const size_t position = builder.accessor(
      fmt::format(R"("bufferView":{},"componentType":5120,"normalized":true,"count":4,"type":"VEC3")",
                  bytes) +
      fmt::format(fmt::runtime(sparse), at, to));
  const size_t target = builder.accessor(R"("componentType":5126,"count":4,"type":"VEC3")" +
                                         fmt::format(fmt::runtime(sparse), at, by));
  const size_t indices = builder.indices(tetrahedronTriangles());
  const size_t moves = builder.floats({0, 0, 0, 5, 0, 0}, "VEC3");
  return builder.gltf(fmt::format(
      R"("extensionsUsed":["ACME_x"],"extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{{"mesh":0,)"
      R"("extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{}}}}}}}}},{{"mesh":0,)"
      R"("weights":[0.5],"extensions":{{"KHR_node_visibility":{{"visible":true}}}}}}],"meshes":[{{"weights":[1],)"
      R"("primitives":[{{"attributes":{{"POSITION":{}}},"indices":{},"targets":[{{"POSITION":{}}}]}},)"
      R"({{"attributes":{{"POSITION":{}}},"mode":1}}]}}])",
      moves, position, indices, target, position));
}

std::vector<Vec3> tetrahedron() { return {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}; }
std::vector<uint16_t> tetrahedronTriangles() { return {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}; }

}  // namespace strandcast::samples
