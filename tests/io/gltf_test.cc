// glTF features besides plain triangles: accessors of all kinds, morph targets, instances, extensions; and
// the report of what is left out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "io/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

using samples::Bytes;
using samples::GltfBuilder;
using samples::tetrahedron;
using samples::tetrahedronTriangles;

TriangleMesh meshOf(const Bytes& bytes) { return readGltfMesh(bytes, "body.gltf").mesh; }
void expectRefusal(const Bytes& bytes, const std::vector<std::string>& parts) {
  expectError([&] { readGltfMesh(bytes, "body.gltf"); }, parts);
}
bool says(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}
void expectPoints(const TriangleMesh& mesh, const std::vector<Vec3>& points, float within = 0) {
  ASSERT_EQ(mesh.positions.size(), points.size());
  for (size_t v = 0; v < points.size(); ++v)
    EXPECT_LE((mesh.positions[v] - points[v]).norm(), within) << "vertex " << v;
}

/// A body with one tetrahedron whose positions are accessor `position` of the builder.
Bytes tetrahedronOf(GltfBuilder& builder, size_t position, const std::string& more = "") {
  const size_t indices = builder.indices(tetrahedronTriangles());
  return builder.body(fmt::format(R"("attributes":{{"POSITION":{}}},"indices":{})", position, indices), more);
}

TEST(GltfAccessors, SparseValuesReplaceThoseOfTheView) {
  std::vector<Vec3> expected = tetrahedron();
  expected[3] = Vec3(0, 0, 5);
  expected[1] = Vec3(2, 0, 0);
  for (const int index_type : {5121, 5123, 5125}) {
    GltfBuilder builder;
    const size_t base = builder.view<float>({0, 0, 0, 9, 9, 9, 0, 1, 0, 9, 9, 9});
    const size_t indices = index_type == 5121   ? builder.view<uint8_t>({7, 1, 3})
                           : index_type == 5123 ? builder.view<uint16_t>({7, 1, 3})
                                                : builder.view<uint32_t>({7, 1, 3});
    const int index_bytes = index_type == 5121 ? 1 : index_type == 5123 ? 2 : 4;
    const size_t values = builder.view<float>({8, 2, 0, 0, 0, 0, 5});
    const size_t sparse = builder.accessor(fmt::format(
        R"("bufferView":{},"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":2,)"
        R"("indices":{{"bufferView":{},"componentType":{},"byteOffset":{}}},"values":{{"bufferView":{},"byteOffset":4}}}})",
        base, indices, index_type, index_bytes, values));
    expectPoints(meshOf(tetrahedronOf(builder, sparse)), expected);
  }
}

TEST(GltfAccessors, WithoutAViewHoldZerosThatSparseValuesReplace) {
  GltfBuilder builder;
  const size_t indices = builder.view<uint8_t>({1, 2, 3});
  const size_t values = builder.view<float>({1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string sparse = fmt::format(
      R"(,"sparse":{{"count":3,"indices":{{"bufferView":{},"componentType":5121}},"values":{{"bufferView":{}}}}})",
      indices, values);
  const std::string head = R"("componentType":5126,"count":4,"type":"VEC3")";
  const size_t replaced = builder.accessor(head + sparse), zeros = builder.accessor(head),
               none = builder.accessor(head + R"(,"sparse":{"count":0})");
  expectPoints(meshOf(tetrahedronOf(builder, replaced)), tetrahedron());
  expectPoints(meshOf(tetrahedronOf(builder, zeros)), std::vector<Vec3>(4, Vec3::Zero()));
  expectPoints(meshOf(tetrahedronOf(builder, none)), std::vector<Vec3>(4, Vec3::Zero()));
}

TEST(GltfAccessors, SparseIndicesOfTrianglesAndAStrideUnderThem) {
  GltfBuilder builder;
  std::vector<float> wide;  // positions interleaved with other numbers
  for (const Vec3& p : tetrahedron()) wide.insert(wide.end(), {p.x(), p.y(), p.z(), 7, 7});
  const size_t base = builder.view(wide, R"(,"byteStride":20)");
  const size_t at = builder.view<uint16_t>({2}), to = builder.view<float>({0, 3, 0});
  const size_t position = builder.accessor(
      fmt::format(R"("bufferView":{},"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,)"
                  R"("indices":{{"bufferView":{},"componentType":5123}},"values":{{"bufferView":{}}}}})",
                  base, at, to));
  std::vector<uint16_t> triangles = tetrahedronTriangles();
  triangles[0] = 3;
  const size_t first = builder.view(triangles), zero = builder.view<uint8_t>({0}),
               corner = builder.view<uint16_t>({0});
  const size_t indices = builder.accessor(
      fmt::format(R"("bufferView":{},"componentType":5123,"count":12,"type":"SCALAR","sparse":{{"count":1,)"
                  R"("indices":{{"bufferView":{},"componentType":5121}},"values":{{"bufferView":{}}}}})",
                  first, zero, corner));
  const TriangleMesh mesh =
      meshOf(builder.body(fmt::format(R"("attributes":{{"POSITION":{}}},"indices":{})", position, indices)));
  expectPoints(mesh, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 3, 0), Vec3(0, 0, 1)});
  EXPECT_EQ(mesh.triangles.front(), (std::array<uint32_t, 3>{0, 2, 1}));
}

TEST(GltfAccessors, SparseOnesThatDoNotFitAreRefused) {
  const auto refused = [](const std::string& sparse, const std::string& what) {
    GltfBuilder builder;
    builder.view<uint8_t>({1, 4});
    builder.view<float>({1, 2, 3, 4, 5, 6});
    const size_t position =
        builder.accessor(R"("componentType":5126,"count":4,"type":"VEC3","sparse":)" + sparse);
    expectRefusal(tetrahedronOf(builder, position), {"body.gltf, accessors[0]", what});
  };
  const std::string values = R"(,"values":{"bufferView":1}})";
  refused("[]", "not an object");
  refused(R"({"count":5,"indices":{"bufferView":0,"componentType":5121})" + values, "count is not 0 to 4");
  refused(R"({"count":2,"indices":{"bufferView":0,"componentType":5121})" + values, "sparse index 4");
  refused(R"({"count":1,"indices":{"bufferView":0,"componentType":5126})" + values, "without a sign");
  refused(R"({"count":1,"indices":{"componentType":5121})" + values, "sparse indices have no bufferView");
  refused(R"({"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{}})", "sparse values have");
  refused(R"({"count":3,"indices":{"bufferView":0,"componentType":5121})" + values,
          "3 sparse indices do not");
  refused(
      R"({"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1,"byteOffset":16}})",
      "1 sparse values do not");
}

TEST(GltfAccessors, ManyElementsThatAreNotInTheFileAreRefused) {
  GltfBuilder builder;
  const size_t position = builder.accessor(R"("componentType":5126,"count":100000000,"type":"VEC3")");
  expectRefusal(tetrahedronOf(builder, position), {"accessors[0]", "too many"});
}

TEST(GltfAccessors, QuantizedPositionsAreReadAsTheyAreMeant) {
  const std::string head = R"(,"count":4,"type":"VEC3","componentType":)";
  const auto read = [&](GltfBuilder& builder, size_t view, const std::string& more) {
    const size_t position = builder.accessor(fmt::format(R"("bufferView":{})", view) + head + more);
    return meshOf(tetrahedronOf(builder, position, R"("extensionsRequired":["KHR_mesh_quantization"])"));
  };
  {
    GltfBuilder builder;  // padded to 4 bytes, as the extension demands
    const size_t view = builder.view<int8_t>({0, 0, 0, 9, 127, 0, 0, 9, 0, 127, 0, 9, 0, -128, -127, 9},
                                             R"(,"byteStride":4)");
    expectPoints(read(builder, view, R"(5120,"normalized":true)"),
                 {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, -1)});
    expectPoints(read(builder, view, "5120"),
                 {Vec3(0, 0, 0), Vec3(127, 0, 0), Vec3(0, 127, 0), Vec3(0, -128, -127)});
  }
  GltfBuilder builder;
  const size_t shorts = builder.view<uint16_t>({0, 0, 0, 65535, 0, 0, 0, 13107, 0, 0, 0, 65535});
  expectPoints(read(builder, shorts, R"(5123,"normalized":true)"),
               {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0.2f, 0), Vec3(0, 0, 1)}, 1e-7f);
  expectPoints(read(builder, shorts, R"(5122,"normalized":true)").positions.size() == 4
                   ? read(builder, shorts, "5123")
                   : TriangleMesh(),
               {Vec3(0, 0, 0), Vec3(65535, 0, 0), Vec3(0, 13107, 0), Vec3(0, 0, 65535)});
  const size_t bytes = builder.view<uint8_t>({0, 0, 0, 255, 0, 0, 0, 51, 0, 0, 0, 255});
  expectPoints(read(builder, bytes, R"(5121,"normalized":true)"),
               {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0.2f, 0), Vec3(0, 0, 1)}, 1e-7f);
  const size_t words = builder.view<uint32_t>(std::vector<uint32_t>(12, 1));
  const size_t position = builder.accessor(fmt::format(R"("bufferView":{})", words) + head + "5125");
  expectRefusal(tetrahedronOf(builder, position), {"neither 32-bit floats"});
}

TEST(GltfPrimitives, ThoseThatHaveNoTrianglesAreLeftOutAndSaid) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  const size_t no_points = builder.accessor(R"("componentType":5126,"count":0,"type":"VEC3")"),
               no_indices = builder.accessor(R"("componentType":5123,"count":0,"type":"SCALAR")");
  const std::string good =
      fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{}}})", position, indices);
  const auto read = [&](const std::string& primitives) {
    return builder.gltf(
        fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}])", primitives));
  };
  const std::pair<std::string, std::string> odd[] = {
      {fmt::format(R"({{"attributes":{{"POSITION":{}}},"mode":0}})", position), "points or lines"},
      {fmt::format(R"({{"attributes":{{"POSITION":{}}},"mode":3}})", position), "points or lines"},
      {fmt::format(R"({{"attributes":{{"POSITION":{}}},"mode":7}})", position), "unknown mode 7"},
      {R"({"attributes":{"NORMAL":0}})", "without POSITION"},
      {R"({"indices":1})", "without attributes"},
      {fmt::format(R"({{"attributes":{{"POSITION":{}}}}})", no_points), "positions is empty"},
      {fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{}}})", position, no_indices),
       "indices is empty"}};
  for (const auto& [primitive, words] : odd) {
    const ReadMesh mesh = readGltfMesh(read(primitive + "," + good + "," + primitive), "body.gltf");
    EXPECT_EQ(mesh.mesh.triangles.size(), 4u);
    ASSERT_EQ(mesh.report.left_out.size(), 1u);
    EXPECT_NE(mesh.report.left_out[0].find(words), std::string::npos) << mesh.report.left_out[0];
    EXPECT_NE(mesh.report.left_out[0].find("(2: meshes[0].primitives[0], meshes[0].primitives[2])"),
              std::string::npos)
        << mesh.report.left_out[0];
    expectRefusal(read(primitive), {"no triangles", words, "meshes[0].primitives[0]"});
  }
  EXPECT_TRUE(readGltfMesh(read(good), "body.gltf").report.left_out.empty());
}

/// A tetrahedron with two targets: one raises its apex by 1, the other moves its second vertex along x by 2.
struct Shapes {
  Shapes() {
    position = builder.points(tetrahedron());
    indices = builder.indices(tetrahedronTriangles());
    up = builder.points({Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3(0, 0, 1)});
    const size_t at = builder.view<uint16_t>({1}), to = builder.view<float>({2, 0, 0});
    along = builder.accessor(
        fmt::format(R"("componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,)"
                    R"("indices":{{"bufferView":{},"componentType":5123}},"values":{{"bufferView":{}}}}})",
                    at, to));
  }
  std::string primitive(const std::string& targets) const {
    return fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{},"targets":[{}]}})", position, indices,
                       targets);
  }
  std::string both() const {
    return fmt::format(R"({{"POSITION":{}}},{{"NORMAL":9,"POSITION":{}}})", up, along);
  }
  Bytes with(const std::string& node, const std::string& mesh, const std::string& primitives) const {
    return builder.gltf(fmt::format(R"("nodes":[{{"mesh":0{}}}],"meshes":[{{"primitives":[{}]{}}}])", node,
                                    primitives, mesh));
  }
  static std::vector<Vec3> shaped(float first, float second) {
    std::vector<Vec3> points = tetrahedron();
    points[3].z() += first;
    points[1].x() += 2 * second;
    return points;
  }
  GltfBuilder builder;
  size_t position, indices, up, along;
};

TEST(GltfMorphTargets, AreAppliedWithTheNodesWeightsOverTheMeshs) {
  const Shapes shapes;
  const std::string both = shapes.primitive(shapes.both());
  expectPoints(meshOf(shapes.with("", "", both)), Shapes::shaped(0, 0));
  expectPoints(meshOf(shapes.with("", R"(,"weights":[1,0.5])", both)), Shapes::shaped(1, 0.5f));
  expectPoints(meshOf(shapes.with(R"(,"weights":[0,0.25])", R"(,"weights":[1,0.5])", both)),
               Shapes::shaped(0, 0.25f));
  expectPoints(meshOf(shapes.with(R"(,"weights":[-0.5,2])", "", both)), Shapes::shaped(-0.5f, 2));
  expectPoints(meshOf(shapes.with(R"(,"weights":[1,0],"scale":[2,2,2])",
                                  R"(,"extras":{"targetNames":["a","b"]})", both)),
               {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 4)});
}

TEST(GltfMorphTargets, OfPrimitivesThatShareVerticesKeepThemApartWhereTheyDiffer) {
  const Shapes shapes;
  const std::string one = shapes.primitive(fmt::format(R"({{"POSITION":{}}})", shapes.up)),
                    other = shapes.primitive(fmt::format(R"({{"POSITION":{}}})", shapes.along));
  EXPECT_EQ(meshOf(shapes.with("", "", one + "," + other)).positions.size(), 4u) << "neither is applied";
  const TriangleMesh apart = meshOf(shapes.with("", R"(,"weights":[1])", one + "," + other));
  ASSERT_EQ(apart.positions.size(), 8u);
  EXPECT_EQ(apart.positions[3], Vec3(0, 0, 2));
  EXPECT_EQ(apart.positions[5], Vec3(3, 0, 0));
}

TEST(GltfMorphTargets, ThatDoNotFitCostNoMoreThanThemselves) {
  Shapes shapes;
  const size_t three = shapes.builder.points({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  const auto read = [&](const std::string& targets, const std::string& weights) {
    return readGltfMesh(shapes.with("", R"(,"weights":)" + weights, shapes.primitive(targets)), "body.gltf");
  };
  const ReadMesh fewer =
      read(fmt::format(R"({{"POSITION":{}}},{{"POSITION":{}}})", three, shapes.up), "[1,1]");
  expectPoints(fewer.mesh, Shapes::shaped(1, 0));
  EXPECT_TRUE(says(fewer.report.left_out, "morph targets of another number of vertices"));
  EXPECT_TRUE(says(fewer.report.left_out, "meshes[0].primitives[0].targets[0]"));
  const ReadMesh normals =
      read(fmt::format(R"({{"NORMAL":{}}},{{"POSITION":{}}})", shapes.up, shapes.up), "[1,0]");
  expectPoints(normals.mesh, Shapes::shaped(0, 0));
  EXPECT_TRUE(normals.report.left_out.empty());
  const ReadMesh few = read(shapes.both(), "[1]"), many = read(shapes.both(), "[1,0.5,7]");
  expectPoints(few.mesh, Shapes::shaped(1, 0));
  expectPoints(many.mesh, Shapes::shaped(1, 0.5f));
  for (const ReadMesh& mended : {few, many})
    EXPECT_TRUE(says(mended.report.warnings, "not as many as the morph targets")) << "meshes[0]";
  expectRefusal(shapes.with("", R"(,"weights":["1"])", shapes.primitive(shapes.both())),
                {"weights", "meshes[0]"});
}

TEST(GltfExtensions, RequiredOnesThatAreNotReadAreRefusedByName) {
  const auto with = [](const std::string& members) {
    GltfBuilder builder;
    const size_t position = builder.points(tetrahedron());
    return tetrahedronOf(builder, position, members);
  };
  for (const char* name : {"ACME_soft_bodies", "CESIUM_RTC", "KHR_draco_mesh_compression",
                           "EXT_meshopt_compression", "KHR_animation_pointer"})
    expectRefusal(with(fmt::format(R"("extensionsRequired":["KHR_materials_unlit","{}"])", name)),
                  {name, "extensionsRequired"});
  expectRefusal(with(R"("extensionsRequired":["KHR_draco_mesh_compression"])"), {"without mesh compression"});
  expectRefusal(with(R"("extensionsRequired":{})"), {"extensionsRequired"});
  const ReadMesh harmless = readGltfMesh(
      with(R"("extensionsRequired":["KHR_materials_unlit","KHR_texture_basisu","KHR_lights_punctual",)"
           R"("EXT_texture_webp","KHR_materials_variants","VRMC_vrm","KHR_texture_transform"],)"
           R"("extensionsUsed":["KHR_materials_sheen","KHR_xmp_json_ld"])"),
      "body.gltf");
  EXPECT_TRUE(harmless.report.left_out.empty() && harmless.report.warnings.empty());
  const ReadMesh used =
      readGltfMesh(with(R"("extensionsUsed":["CESIUM_RTC","ACME_soft_bodies","KHR_draco_mesh_compression"])"),
                   "body.gltf");
  ASSERT_EQ(used.report.left_out.size(), 2u) << "what is compressed is there as plain data, too";
  EXPECT_EQ(used.report.left_out[0], "the extension CESIUM_RTC");
  EXPECT_EQ(used.report.left_out[1], "the unknown extension ACME_soft_bodies");
}

TEST(GltfExtensions, CompressedMeshesAreNamedWhereOnlyTheyUseThem) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  const size_t bare = builder.accessor(R"("componentType":5126,"count":4,"type":"VEC3")");
  const std::string draco =
      R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{}}})";
  const auto body = [&](size_t of) {
    return builder.body(fmt::format(R"("attributes":{{"POSITION":{}}},"indices":{})", of, indices) + draco);
  };
  expectRefusal(body(bare),
                {"KHR_draco_mesh_compression", "meshes[0].primitives[0]", "without mesh compression"});
  expectPoints(meshOf(body(position)), tetrahedron());

  const std::string empty =
      R"("buffers":[{"byteLength":48,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":48,"extensions":{"EXT_meshopt_compression":)"
      R"({"buffer":0,"byteLength":20,"byteStride":12,"count":4,"mode":"ATTRIBUTES"}}}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}],)";
  expectRefusal(
      samples::fromText(R"({"asset":{"version":"2.0"},)" + empty +
                        R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})"),
      {"EXT_meshopt_compression", "bufferViews[0]", "without mesh compression"});
}

TEST(GltfInstances, AreCopiesOfAMeshWithinTheirNode) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  const size_t moves = builder.floats({0, 0, 0, 5, 0, 0, 0, 5, 0}, "VEC3"),
               scales = builder.floats({1, 1, 1, 2, 2, 2, -1, 1, 1}, "VEC3"),
               two = builder.floats({1, 1, 1, 2, 2, 2}, "VEC3");
  const size_t turns = builder.accessor(
      fmt::format(R"("bufferView":{},"componentType":5122,"normalized":true,"count":3,"type":"VEC4")",
                  builder.view<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170, 0, 0, 0, 32767})));
  const auto instanced = [&](const std::string& attributes) {
    return builder.gltf(fmt::format(
        R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{{"mesh":0,"translation":[0,0,10],)"
        R"("extensions":{{"EXT_mesh_gpu_instancing":{{{}}}}}}}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}])",
        attributes, position, indices));
  };
  const TriangleMesh mesh = meshOf(instanced(fmt::format(
      R"("attributes":{{"TRANSLATION":{},"ROTATION":{},"SCALE":{},"_ID":99}})", moves, turns, scales)));
  ASSERT_EQ(mesh.positions.size(), 12u);
  EXPECT_LT((mesh.positions[1] - Vec3(1, 0, 10)).norm(), 1e-6f);
  EXPECT_LT((mesh.positions[5] - Vec3(5, 2, 10)).norm(), 1e-3f) << "twice as large, a quarter round z";
  EXPECT_LT((mesh.positions[9] - Vec3(-1, 5, 10)).norm(), 1e-6f) << "mirrored";
  for (size_t copy = 0; copy < 3; ++copy) {
    double volume = 0;
    for (size_t t = 4 * copy; t < 4 * copy + 4; ++t) {
      const auto& c = mesh.triangles[t];
      const Vec3 middle = mesh.positions[4 * copy];
      volume +=
          static_cast<double>((mesh.positions[c[0]] - middle)
                                  .dot((mesh.positions[c[1]] - middle).cross(mesh.positions[c[2]] - middle)));
    }
    EXPECT_GT(volume, 0.9) << "its outside is out, copy " << copy;
  }
  EXPECT_EQ(meshOf(instanced(fmt::format(R"("attributes":{{"TRANSLATION":{}}})", moves))).positions[9],
            Vec3(1, 5, 10));
  EXPECT_EQ(meshOf(instanced(R"("attributes":{"_ID":99})")).positions.size(), 4u);
  expectRefusal(instanced(fmt::format(R"("attributes":{{"TRANSLATION":{},"SCALE":{}}})", moves, two)),
                {"not of one count", "nodes[0].extensions.EXT_mesh_gpu_instancing"});
  expectRefusal(instanced(R"("attributes":7)"), {"no attributes"});
}

TEST(GltfScenes, HiddenNodesAndOtherScenesAreLeftOutAndSaid) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  const ReadMesh read = readGltfMesh(
      builder.gltf(fmt::format(
          R"("scene":1,"scenes":[{{"nodes":[3]}},{{"nodes":[0,1]}}],"extensionsUsed":["KHR_node_visibility"],)"
          R"("nodes":[{{"mesh":0}},{{"children":[2],"extensions":{{"KHR_node_visibility":{{"visible":false}}}}}},)"
          R"({{"mesh":0}},{{"mesh":0}}],)"
          R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}])",
          position, indices)),
      "body.gltf");
  EXPECT_EQ(read.mesh.positions.size(), 4u);
  EXPECT_TRUE(says(read.report.left_out, "hidden meshes (nodes[2])"));
  EXPECT_TRUE(says(read.report.left_out, "another scene"));
}

TEST(GltfLimits, MeshesMayBeRepeatedFarMoreOftenThanTheFileIsLarge) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  std::string nodes;
  for (int n = 0; n < 2000; ++n)
    nodes += fmt::format(R"({}{{"mesh":0,"translation":[{},0,0]}})", n > 0 ? "," : "", n);
  const Bytes bytes = builder.gltf(fmt::format(
      R"("nodes":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}])", nodes,
      position, indices));
  EXPECT_EQ(meshOf(bytes).positions.size(), 8000u);
  GltfLimits few;
  few.vertices = 7999;
  expectError([&] { readGltfMesh(bytes, "body.gltf", few); },
              {"more than 7999 vertices", "meshes[0].primitives[0]"});
  few = {};
  few.primitives = 1999;
  expectError([&] { readGltfMesh(bytes, "body.gltf", few); }, {"more than 1999 primitives"});
  few = {};
  few.triangles = 7000;
  expectError([&] { readGltfMesh(bytes, "body.gltf", few); }, {"more than 7000 triangles"});
}

TEST(GltfLimits, OfInstancesAndTargetsHoldBeforeTheyAreMade) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron()), indices = builder.indices(tetrahedronTriangles());
  const size_t zeros = builder.accessor(R"("componentType":5126,"count":20000000,"type":"VEC3")");
  expectRefusal(
      builder.gltf(fmt::format(
          R"("nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"SCALE":{}}}}}}}}}],)"
          R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}])",
          zeros, position, indices)),
      {"20000000 instances", "1000000"});
  const Shapes shapes;
  GltfLimits few;
  few.target_vertices = 7;
  expectError(
      [&] {
        readGltfMesh(shapes.with("", R"(,"weights":[1,1])", shapes.primitive(shapes.both())), "body.gltf",
                     few);
      },
      {"more than 7 vertices of morph targets"});
}

TEST(GltfBuffers, OfOneFileMayBeTwo) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron());
  const Bytes whole = tetrahedronOf(builder, position);
  std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
  const size_t at = text.find(R"("buffers":[)") + 11;
  const std::string buffer = text.substr(at, text.size() - at - 2);
  text.insert(at, buffer + ",");
  text.replace(text.find(R"({"buffer":0)"), 11, R"({"buffer":1)");
  expectPoints(meshOf(samples::fromText(text)), tetrahedron());
}

TEST(GltfAssets, AMinimumVersionAbove2IsRefusedByName) {
  const auto with = [](const std::string& asset) {
    GltfBuilder builder;
    const Bytes plain = tetrahedronOf(builder, builder.points(tetrahedron()));
    std::string text(reinterpret_cast<const char*>(plain.data()), plain.size());
    const std::string version = R"("version":"2.0")";
    return samples::fromText(text.replace(text.find(version), version.size(), asset));
  };
  for (const char* least : {"2.1", "2.10", "3.0", "10.0", "99999999999999999999.0"})
    expectRefusal(with(fmt::format(R"("version":"2.9","minVersion":"{}")", least)),
                  {std::string("requires glTF ") + least, "asset.minVersion", "as glTF 2.0"});
  for (const char* fine : {R"("version":"2.0","minVersion":"2.0")", R"("version":"2.0","minVersion":"1.9")",
                           R"("version":"2.0","minVersion":"2.00")"})
    EXPECT_TRUE(readGltfMesh(with(fine), "body.gltf").report.warnings.empty()) << fine;
  const auto doubts = [&](const std::string& asset) {
    return readGltfMesh(with(asset), "body.gltf").report.warnings;
  };
  EXPECT_TRUE(says(doubts(R"("version":"2.1")"), "asset.version is 2.1: it is read as glTF 2.0"));
  for (const char* none : {R"("two")", R"("2")", R"("2.")", R"("-2.1")", "3", "{}"})
    EXPECT_TRUE(says(doubts(fmt::format(R"("version":"2.0","minVersion":{})", none)),
                     "asset.minVersion is not a version"))
        << none;
}

TEST(GltfAssets, TextInUtf16IsRefusedAsSuch) {
  GltfBuilder builder;
  Bytes wide{std::byte{0xff}, std::byte{0xfe}};
  for (const std::byte c : tetrahedronOf(builder, builder.points(tetrahedron())))
    wide.insert(wide.end(), {c, std::byte{0}});
  expectRefusal(wide, {"UTF-16", "body.gltf", "iconv -f UTF-16 -t UTF-8"});
  wide.erase(wide.begin(), wide.begin() + 2);
  expectRefusal(wide, {"UTF-16", "iconv -f UTF-16LE -t UTF-8"});
}

TEST(GltfPrimitives, CornersThatMakeNoWholeTriangleAreReported) {
  GltfBuilder builder;
  const size_t position = builder.points(tetrahedron());
  std::vector<uint16_t> triangles = tetrahedronTriangles();
  triangles.push_back(0);
  const size_t one_more = builder.indices(triangles), two = builder.indices({0, 1});
  const std::string whole = fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{}}})", position,
                                        builder.indices(tetrahedronTriangles()));
  const auto told = [&](const std::string& primitive) {
    const ReadMesh read =
        readGltfMesh(builder.gltf(fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{},{}]}}])",
                                              whole, primitive)),
                     "body.gltf");
    EXPECT_EQ(read.report.left_out.size(), 1u);
    return read.report.left_out.empty() ? "" : read.report.left_out[0];
  };
  const std::string attributes = fmt::format(R"({{"attributes":{{"POSITION":{}}})", position);
  const std::string indices = "indices left over after the last whole triangle (meshes[0].primitives[1])";
  EXPECT_EQ(told(attributes + fmt::format(R"(,"indices":{}}})", one_more)), indices);
  EXPECT_EQ(told(attributes + fmt::format(R"(,"indices":{}}})", two)), indices);
  EXPECT_EQ(told(attributes + fmt::format(R"(,"indices":{},"mode":5}})", two)), indices);
  EXPECT_EQ(told(attributes + "}"),
            "vertices left over after the last whole triangle (meshes[0].primitives[1])");
}

TEST(GltfMorphTargets, OfAnotherCountAreReportedOnceWhetherUsedOrNot) {
  Shapes shapes;
  const size_t three = shapes.builder.points({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}),
               five = shapes.builder.points(std::vector<Vec3>(5, Vec3::Zero()));
  const std::string targets =
      fmt::format(R"({{"POSITION":{}}},{{"POSITION":{}}},{{"POSITION":{}}})", shapes.up, three, five);
  for (const char* weights :
       {"", R"(,"weights":[1,0,0])", R"(,"weights":[0,1,0])", R"(,"weights":[1,1,1])"}) {
    const ReadMesh read =
        readGltfMesh(shapes.builder.gltf(fmt::format(
                         R"("nodes":[{{"mesh":0}},{{"mesh":0}}],"meshes":[{{"primitives":[{}]{}}}])",
                         shapes.primitive(targets), weights)),
                     "body.gltf");
    EXPECT_EQ(
        read.report.left_out,
        (std::vector<std::string>{"morph targets of another number of vertices (2: "
                                  "meshes[0].primitives[0].targets[1], meshes[0].primitives[0].targets[2])"}))
        << weights;
  }
}

}  // namespace
}  // namespace strandcast
