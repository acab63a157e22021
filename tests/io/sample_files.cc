#include "tests/io/sample_files.h"

#include <array>

#include "io/distance_field_file.h"
#include "io/little_endian.h"

namespace strandcast::samples {
namespace {

constexpr char kGltfHead[] =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
    R"("nodes":[{"mesh":0,"children":[1]},{"mesh":0,"translation":[0,0,1],)"
    R"("rotation":[0,0.7071068,0,0.7071068],"scale":[2,2,2]}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],)"
    R"("bufferViews":[{"buffer":0,"byteLength":48},)"
    R"({"buffer":0,"byteOffset":48,"byteLength":12}],"images":[{"uri":"nowhere.png"}],)";

Bytes quadBuffer() {
  ByteWriter writer;
  for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) writer.put(corner);
  for (const uint16_t index : {0, 1, 2, 0, 2, 3}) writer.put(index);
  return writer.take();
}

}  // namespace

Vec3 vertex(size_t s, size_t i) {
  const auto along = static_cast<float>(i);
  return {0.05f * static_cast<float>(s), 0.1f + 0.03f * along, 0.01f * along * along};
}

Bytes fromText(const std::string& text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::string base64(const Bytes& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | static_cast<uint32_t>(bytes[i + k]);
    for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[bits >> shift & 63];
  }
  return text;
}

Bytes tfx3(bool both_ends_immovable) {
  ByteWriter writer;
  writer.put(3.0f);
  for (const uint32_t field : {3u, 4u, 0u, both_ends_immovable ? 1u : 0u}) writer.put(field);
  writer.zeros(31 * 4);
  writer.put(uint32_t{296});
  writer.zeros(296 - 148);
  for (size_t s = 0; s < 3; ++s)
    for (size_t i = 0; i < 4; ++i) writer.put(vertex(s, i));
  return writer.take();
}

Bytes tfx4() {
  ByteWriter writer;
  writer.put(4.0f);
  for (const uint32_t field : {3u, 4u, 160u, 160u + 3 * 4 * 16}) writer.put(field);
  writer.zeros(160 - 20);
  for (size_t s = 0; s < 3; ++s)
    for (size_t i = 0; i < 4; ++i) {
      writer.put(vertex(s, i));
      writer.put(i < 2 ? 0.0f : 1.0f);
    }
  for (size_t s = 0; s < 3; ++s) {
    writer.put(0.25f * static_cast<float>(s));
    writer.put(0.5f);
  }
  return writer.take();
}

Bytes hair() {
  constexpr std::array<uint16_t, 3> kSegments{1, 2, 4};
  ByteWriter writer;
  writer.raw("HAIR", 4);
  for (const uint32_t field : {3u, 10u, 31u, 0u}) writer.put(field);
  for (const float field : {1.0f, 0.0f, 0.5f, 0.5f, 0.5f}) writer.put(field);
  writer.zeros(88);
  for (const uint16_t segments : kSegments) writer.put(segments);
  for (size_t s = 0; s < 3; ++s)
    for (size_t i = 0; i <= kSegments[s]; ++i) writer.put(vertex(s, i));
  for (int i = 0; i < 10; ++i) writer.put(0.02f * static_cast<float>(i));
  for (int i = 0; i < 4 * 10; ++i) writer.put(0.5f);
  return writer.take();
}

Bytes hairDefaultSegments() {
  ByteWriter writer;
  writer.raw("HAIR", 4);
  for (const uint32_t field : {2u, 8u, 2u, 3u}) writer.put(field);
  writer.zeros(128 - 20);
  for (size_t s = 0; s < 2; ++s)
    for (size_t i = 0; i < 4; ++i) writer.put(vertex(s, i));
  return writer.take();
}

Bytes objStrands() {
  return fromText(
      "# three strands\n"
      "v 0 0.1 0\nv 0 0.2 0 1 0 0\nv 0 0.3 +0.01\nv 0 0.4 0.03\r\n"
      "l 1 2/7 3 4\n"
      "o second\nv 1e-1 0.1 0 0.5\nv 0.1 0.2 0\nv 0.1 0.3 0.05\n"
      "l -3 -2 \\\n -1\n"
      "l 1 5\nl 5 6  # an edge at a time\n");
}

Bytes usda() {
  return fromText(R"(#usda 1.0
(
    "a head"
    defaultPrim = "head"
    metersPerUnit = 0.01
    customLayerData = { string tool = "by } hand"; double[] none = [] }
    upAxis = "Z"
)

def Xform "head" (
    prepend apiSchemas = ["Tag"]
    doc = """lines
of ) text"""
)
{
    matrix4d xformOp:transform = ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 10, 1) )
    uniform token[] xformOpOrder = ["xformOp:transform"]
    rel material:binding = </mat> ( bindMaterialAs = "weaker" )

    def BasisCurves "straight"
    {
        int[] curveVertexCounts = [4, 3]
        point3f[] points = [(0, 0, 0), (0, 0, 1), (0, 0, 2), (0, 0.5, 3),
            (1, 0, 0), (1, 0, 1), (1, 1e-1, 2),]  # seven
        texCoord2f[] primvars:st = [(0.25, 0.5), (0.75, 0.5)] ( interpolation = "uniform" )
        uniform token type = "linear"
        float[] widths = [0.02] ( interpolation = "constant" ); custom float x
        float3 xformOp:rotateXYZ = (0, 0, 90)
        double3 xformOp:translate = (5, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }
    def BasisCurves "curly" ( active = true; variants = { string style = "a" } )
    {
        int[] curveVertexCounts = [4]
        point3f[] points.timeSamples = { 1: [(0, 0, 0), (0, 0, 3), (3, 0, 3), (3, 0, 0)], 2: [(0, 0, 0)], }
        uniform token basis = "bezier"
        texCoord2f[] primvars:st = [(0, 0)]
        float[] widths = [0.02, 0.02, 0.02, 0.02]
        variantSet "style" = { "a" { def Scope "in } it" {} } }
    }
    over "hat" { def BasisCurves "none" { point3f[] points = None } }
    class BasisCurves "kind" { int[] curveVertexCounts = [9] }
}
)");
}

Bytes usdaStage() {
  return fromText(R"(#usda 1.1
( subLayers = [@a.usda@ (offset = 1)]; relocates = { <a>: <b> } )
/* a ( comment */
def Xform "g" ( variants = { string v = "x" }; prepend references = [@@@b@c.usda@@@</p>, </q>] )
{
    double xformOp:translateX = 1; float xformOp:scaleY.timeSamples = { 2: 3, 1: 2 }
    uniform token[] xformOpOrder = ["xformOp:translateX", "!invert!xformOp:scaleY", "xformOp:none"]
    texCoord2f[] primvars:st = [(0, 0.5)] ( interpolation = "constant" )
    variantSet "v" = {
        "x" { over "c" { token visibility = "inherited" }
            def BasisCurves "d" { int[] curveVertexCounts = [4]
                point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (3,0,0)]
                uniform token basis = "bspline"; uniform token wrap = "pinned" } }
        "y" { def Scope "z" {} }
    }
    def BasisCurves "c" // two short curves
    {
        int[] curveVertexCounts = [4, 3, 0, 7]
        point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (3,0,0), (0,1,0), (1,1,0), (2,1,0),
            (0,0,0), (1,0,0), (2,0,0), (3,0,0), (4,0,0), (5,0,0), (6,nan,0)]
        float[] primvars:widths = [0.1, -1, inf, 0.2] ( interpolation = "varying"; unauthoredValuesIndex = 3 )
        int[] primvars:widths:indices = [0, 1, 2, 3, 9, -1, 0, 0, 0]
        float[] primvars:uv = [1, 2, 3, 4, 5, 6, 7, 8] ( elementSize = 2; interpolation = "uniform" )
        color3f[] primvars:displayColor = [(1, 0, 0)]
    }
    def Scope "hidden" { token visibility = "invisible"
        def BasisCurves "e" { uniform token purpose = "guide" } }
    def PointInstancer "i" { def BasisCurves "f" {} }
    def BasisCurves "faulty" { int[] curveVertexCounts = [1e9]; uniform token wrap = "periodic" }
    def BasisCurves "linear" { uniform token type = 'linear'; int[] curveVertexCounts = [2]
        point3f[] points.timeSamples = { 1: [(0, 0, 0), (0, 1, 0)] } }
}
)");
}

Bytes usdaLabels() {
  return fromText(R"(#usda 1.0
( metersPerUnit = 1 )
def Xform "g"
{
    color3f[] primvars:displayColor = [(0.5, 0.25, 0.125)]
    def BasisCurves "a"
    {
        uniform token type = "linear"
        int[] curveVertexCounts = [2, 3]
        point3f[] points = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)]
        bool[] primvars:groom_guide = [true, false] ( interpolation = "uniform" )
        int[] groom_id = [7, 4294967295] ( interpolation = "uniform" )
        int[] primvars:groom_group_id = [3, -1] ( interpolation = "uniform" )
        int[] primvars:groom_group_id:indices = [1, 0]
        string[] primvars:groom_group_name = ["a \"b\"", "c\x07"] ( interpolation = "uniform" )
        float[] groom_width = [0.1, 0.2, 0.3, 0.4, 0.5] ( interpolation = "vertex" )
        float2[] groom_root_uv = [(0.25, 0.5), (0.5, 0.75)] ( interpolation = "uniform" )
        color3f[] primvars:groom_color = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -1, 0), (1, 1, 1)] (
            interpolation = "vertex" )
    }
    def BasisCurves "b"
    {
        int[] curveVertexCounts = [4]
        point3f[] points = [(2, 0, 0), (2, 1, 0), (2, 2, 0), (2, 3, 0)]
        int[] primvars:groom_id = [9] ( interpolation = "constant" )
        float2[] groom_root_uv = [(0.25, 0.5)]
        float groom_width = 0.1 ( interpolation = "constant" )
    }
}
)");
}

Bytes objMesh() {
  return fromText(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "v 50 50 50\nv 51 50 50\nv 50 51 50\n"
      "g body\n"
      "f 4/1 3/1 2/1 1/1\nf 5//1 6//1 7//1 8//1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
      "g helper-box\nf -3 -2 -1\n");
}

Bytes glb() {
  std::string text = std::string(kGltfHead) + R"("buffers":[{"byteLength":60}]})";
  while (text.size() % 4 != 0) text += ' ';
  const Bytes buffer = quadBuffer();
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

Bytes gltf() {
  return fromText(std::string(kGltfHead) +
                  R"("buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
                  base64(quadBuffer()) + R"("}]})");
}

DistanceField field() {
  DistanceField field;
  field.grid = {{0, 0, 0}, 0.001f, {3, 1, 2}, 0.003f, 1e-6f, 0, 0, 0};
  const auto distance = [](const Vec3& p) { return (p - Vec3(0.012f, 0.004f, 0.004f)).norm() - 0.005f; };
  for (uint32_t brick = 0; brick < 6; ++brick) {
    const bool stored = brick == 1 || brick == 4;
    field.index.push_back(stored ? brick / 4 : brick == 0 ? kInsideBrick : kOutsideBrick);
    if (!stored) continue;
    const size_t first = field.samples.size();
    field.samples.resize(first + kBrickWords);
    for (uint32_t n = 0; n < kBrickSamples; ++n) {
      const uint32_t i = n % kBrickSide, j = n / kBrickSide % kBrickSide, k = n / kBrickSide / kBrickSide;
      const Vec3 p = samplePosition(field.grid, brick % 3 * kBrickCells + i, j, brick / 3 * kBrickCells + k);
      const auto units = static_cast<int16_t>(distance(p) / field.grid.quantum);
      field.samples[first + n / 2] |= uint32_t{static_cast<uint16_t>(units)} << (16 * (n % 2));
    }
  }
  for (uint32_t c = 0; c < 4 * 2 * 3; ++c)
    field.corners.push_back(distance(
        samplePosition(field.grid, c % 4 * kBrickCells, c / 4 % 2 * kBrickCells, c / 8 * kBrickCells)));
  return field;
}

Bytes sdf() { return encodeDistanceField(field(), kFieldKey); }

}  // namespace strandcast::samples
