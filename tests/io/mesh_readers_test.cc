// Mesh readers on small files: what they read, and what they refuse with which error.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

using samples::Bytes;
using samples::fromText;
using samples::overwrite;

/// Six times the signed volume of a mesh, positive if its triangles are counter-clockwise from outside.
double sixVolumes(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += mesh.positions[t[0]].cast<double>().dot(
        mesh.positions[t[1]].cast<double>().cross(mesh.positions[t[2]].cast<double>()));
  return sum;
}

void expectObjMeshError(const std::string& text, const std::string& place) {
  expectError([&] { readObjMesh(fromText(text), "body.obj"); }, {"body.obj", place});
}

/// samples::gltf() with its first `from` replaced.
Bytes gltfWith(const std::string& from, const std::string& to) {
  const Bytes whole = samples::gltf();
  std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return fromText(text.replace(at, from.size(), to));
}

void expectGltfError(const Bytes& bytes, const std::string& place) {
  expectError([&] { readGltfMesh(bytes, "body.gltf"); }, {"body.gltf", place});
}

TEST(ObjMesh, SkippedGroupsLeaveNothingBehind) {
  const TriangleMesh cube = readObjMesh(samples::objMesh(), "body.obj", {"helper-", "joint-"}).mesh;
  EXPECT_EQ(cube.positions.size(), 8u);
  EXPECT_EQ(cube.triangles.size(), 12u);
  EXPECT_EQ(cube.normals.size(), 8u);
  EXPECT_NEAR(sixVolumes(cube), 6, 1e-6);
  EXPECT_FLOAT_EQ(cube.bounds().max().x(), 1);
}

TEST(ObjMesh, WithoutSkippedGroupsEveryFaceIsThere) {
  const TriangleMesh mesh = readObjMesh(samples::objMesh(), "body.obj").mesh;
  EXPECT_EQ(mesh.triangles.size(), 13u);
  EXPECT_EQ(mesh.positions.size(), 11u);
}

TEST(ObjMesh, BadLinesAreRefusedWithTheirNumber) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expectObjMeshError("", "line 1");
  expectObjMeshError(triangle, "no faces");
  expectObjMeshError(triangle + "f 1 2\n", "no faces");
  expectObjMeshError(triangle + "f 1 2 4\n", "line 4");
  expectObjMeshError(triangle + "f 1 2 -4\n", "line 4");
  expectObjMeshError(triangle + "f 1 2 0\n", "line 4");
  expectObjMeshError(triangle + "f 1 2 /3\n", "line 4");
  expectObjMeshError(triangle + "f 1 2 3\nv 0 0\n", "line 5");
  expectObjMeshError(triangle + "f 1 1 1\n", "no faces");
}

TEST(ObjMesh, NumbersTooSmallForADoubleAreZero) {
  const std::string small = "v 1e-400 -0.00012e-999 +0." + std::string(400, '0') + "1\n";
  const TriangleMesh mesh =
      readObjMesh(samples::fromText(small + "v 1 0 0\nv 0 1 0\nf 1 2 3\n"), "body.obj").mesh;
  EXPECT_EQ(mesh.positions[0], Vec3(0, 0, 0));
  for (const char* large : {"1e400", "-12e+999", "1e-400x", "1e39"})
    expectObjMeshError(std::string("v 0 0 ") + large + "\n", "line 1");
  expectObjMeshError("v 0 0 1" + std::string(400, '0') + "e-5\n", "line 1");
}

TEST(GltfMesh, NodesPlaceTheirMeshes) {
  for (const Bytes& bytes : {samples::glb(), samples::gltf()}) {
    const TriangleMesh mesh = readGltfMesh(bytes, "body.glb").mesh;
    ASSERT_EQ(mesh.positions.size(), 8u);
    ASSERT_EQ(mesh.triangles.size(), 4u);
    // The child is scaled by 2, rotated by a quarter turn about y (x -> -z), and moved by 1 along z.
    EXPECT_LT((mesh.positions[5] - Vec3(0, 0, -1)).norm(), 1e-5f);
    EXPECT_LT((mesh.positions[7] - Vec3(0, 2, 1)).norm(), 1e-5f);
    EXPECT_LT((mesh.normals[0] - Vec3(0, 0, 1)).norm(), 1e-5f);
  }
}

TEST(GltfMesh, AMirroringNodeKeepsTheOutsideOut) {
  const TriangleMesh mesh =
      readGltfMesh(gltfWith(R"("scale":[2,2,2])", R"("scale":[-2,2,2])"), "body.gltf").mesh;
  const Vec3 turned_quad_normal(1, 0, 0);  // mirroring keeps the side to which the quad faces
  EXPECT_LT((mesh.normals[5] - turned_quad_normal).norm(), 1e-4f);
}

TEST(GltfMesh, StripsAndFansAndPlainListsAreRead) {
  const Bytes strip = gltfWith(R"("indices":1)", R"("mode":5)");
  EXPECT_EQ(readGltfMesh(strip, "body.gltf").mesh.triangles.size(), 4u);
  const Bytes fan = gltfWith(R"("indices":1)", R"("mode":6)");
  EXPECT_EQ(readGltfMesh(fan, "body.gltf").mesh.triangles[1], (std::array<uint32_t, 3>{0, 2, 3}));
  const Bytes list = gltfWith(R"(,"indices":1)", "");
  EXPECT_EQ(readGltfMesh(list, "body.gltf").mesh.triangles.size(), 2u);
  expectGltfError(gltfWith(R"("indices":1)", R"("indices":1,"mode":1)"), "no triangles");
}

TEST(GltfMesh, AccessorsAndViewsOutsideTheirBufferAreRefused) {
  expectGltfError(gltfWith(R"("count":4)", R"("count":5)"), "accessors[0]");
  expectGltfError(gltfWith(R"("count":4)", R"("count":0)"), "positions is empty");
  expectGltfError(gltfWith(R"("count":4)", R"("count":-4)"), "accessors[0]");
  expectGltfError(gltfWith(R"("count":4)", R"("count":4.5)"), "accessors[0]");
  expectGltfError(gltfWith(R"("count":4)", R"("count":281474976710655)"), "accessors[0]");
  expectGltfError(gltfWith(R"("count":4)", R"("count":1e999)"), "byte ");
  expectGltfError(gltfWith(R"("count":6)", R"("count":7)"), "accessors[1]");
  expectGltfError(gltfWith(R"("bufferView":0,)", R"("bufferView":9,)"), "accessors[0]");
  expectGltfError(gltfWith(R"("bufferView":0,)", R"("bufferView":0,"byteOffset":4,)"), "accessors[0]");
  expectGltfError(gltfWith(R"("bufferView":0,)", R"("bufferView":0,"sparse":{},)"), "accessors[0]");
  expectGltfError(gltfWith("5126", "5125"), "accessors[0]");
  expectGltfError(gltfWith("5123", "5126"), "accessors[1]");
  expectGltfError(gltfWith("VEC3", "VEC2"), "accessors[0]");
  expectGltfError(gltfWith(R"("byteOffset":48)", R"("byteOffset":49)"), "bufferViews[1]");
  expectGltfError(gltfWith(R"({"buffer":0,"byteLength":48})", R"({"buffer":1,"byteLength":48})"),
                  "bufferViews[0]");
  expectGltfError(
      gltfWith(R"({"buffer":0,"byteLength":48})", R"({"buffer":0,"byteLength":48,"byteStride":8})"),
      "bufferViews[0]");
  expectGltfError(gltfWith(R"("byteLength":60)", R"("byteLength":61)"), "buffers[0]");
}

TEST(GltfMesh, NodesThatMakeNoTreeAreRefused) {
  expectGltfError(gltfWith(R"("children":[1])", R"("children":[0])"), "nodes[0]");
  expectGltfError(gltfWith(R"("children":[1])", R"("children":[1,1])"), "nodes[1]");
  expectGltfError(gltfWith(R"("children":[1])", R"("children":[2])"), "nodes[0]");
  expectGltfError(gltfWith(R"("children":[1])", R"("children":{})"), "nodes[0]");
  expectGltfError(gltfWith(R"("scene":0)", R"("scene":1)"), "scene");
  expectGltfError(gltfWith(R"({"mesh":0,"c)", R"({"mesh":3,"c)"), "nodes[0]");
  expectGltfError(gltfWith(R"("scale":[2,2,2])", R"("scale":[2,2])"), "nodes[1]");
  expectGltfError(gltfWith(R"("scale":[2,2,2])", R"("scale":[2,2,1e300])"), "nodes[1]");
  expectGltfError(gltfWith("0.7071068,0,0.7071068]", "0,0,0]"), "nodes[1]");
}

TEST(GltfMesh, BuffersElsewhereAreRefusedAndNeverOpened) {
  for (const std::string uri :
       {"body.bin", "/etc/passwd", "../body.bin", "http://host/body.bin", "data:;base64,@@@@"}) {
    const Bytes whole = samples::gltf();
    std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
    text = text.substr(0, text.find("data:")) + uri + "\"}]}";
    expectGltfError(fromText(text), "buffers[0]");
  }
}

TEST(GltfMesh, BadJsonAndBadContainersAreRefused) {
  expectGltfError({}, "byte 0");
  expectGltfError(fromText("{"), "byte ");
  expectGltfError(fromText("[]"), "byte 0");
  expectGltfError(fromText("{}"), "asset");
  expectGltfError(fromText(R"({"asset":{"version":"1.0"}})"), "asset");
  expectGltfError(fromText(std::string(100000, '[')), "nested");
  expectGltfError(fromText(R"({"asset":")" + std::string(100, '[') + R"(\"[","b":)" + std::string(64, '[')),
                  "nested too deeply: body.gltf, byte 182");
  const Bytes whole = samples::glb();
  for (size_t size = 0; size < whole.size(); ++size)
    expectGltfError(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)), "body.gltf");
  for (const auto& [offset, value] :
       {std::pair<size_t, uint32_t>{4, 1}, {8, 0xFFFFFFFF}, {8, 12}, {12, 0xFFFFFFF0}, {16, 7}}) {
    Bytes bytes = samples::glb();
    overwrite(bytes, offset, value);
    expectGltfError(bytes, "byte ");
  }
}

TEST(LoadMesh, UnitsAxesAndBuffersBesideTheFile) {
  const ScratchFolder folder;
  writeFileBytes(folder / "cube.obj", samples::objMesh());
  const TriangleMesh cube = loadMesh(folder / "cube.obj", {0.1f, UpAxis::kZ}).mesh;
  EXPECT_FLOAT_EQ(cube.bounds().max().x(), 0.1f);
  EXPECT_FLOAT_EQ(cube.bounds().min().z(), -0.1f);
  EXPECT_FLOAT_EQ(cube.bounds().max().z(), 0);
  EXPECT_GT(sixVolumes(cube), 0);
  EXPECT_GT(sixVolumes(loadMesh(folder / "cube.obj", {0.1f, UpAxis::kX}).mesh), 0);

  const Bytes whole = samples::gltf();
  std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
  text = text.substr(0, text.find("data:")) + "quad%20.bin\"}]}";
  writeFileBytes(folder / "quad.gltf", fromText(text));
  const Bytes glb = samples::glb();
  writeFileBytes(folder / "quad .bin", std::span(glb).last(60));
  EXPECT_FLOAT_EQ(loadMesh(folder / "quad.gltf", {}).mesh.bounds().max().y(), 2);
}

TEST(LoadMesh, WhatCannotBeReadIsRefusedWithItsName) {
  const ScratchFolder folder;
  expectError([&] { loadMesh(folder / "body.stl", {}); }, {"body.stl", "byte 0"});
  expectError([&] { loadMesh(folder / "body.obj", {}); }, {"body.obj", "byte 0", "cannot be found"});
  std::filesystem::create_directory(folder / "body.glb");
  expectError([&] { loadMesh(folder / "body.glb", {}); }, {"body.glb", "directory"});
  writeFileBytes(folder / "cube.obj", samples::objMesh());
  expectError([&] { loadMesh(folder / "cube.obj", {-1.0f, UpAxis::kAuto}); }, {"unit_meters -1"});
  expectError([&] { loadMesh(folder / "cube.obj", {1e9f, UpAxis::kAuto}); }, {"cube.obj", "10 km"});
}

}  // namespace
}  // namespace strandcast
