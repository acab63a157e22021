// Universal Scene Description in its text form (https://openusd.org): strands as linear BasisCurves.
#include <fmt/format.h>

#include <iterator>

#include "core/error.h"
#include "io/groom_encode.h"

namespace strandcast {

std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name) {
  if (strands.strands() == 0)
    throw Error("there are no strands to write", name, "choose a groom with strands");
  std::string text = "#usda 1.0\n(\n    defaultPrim = \"hair\"\n    doc = \"written by Strandcast\"\n";
  const auto out = std::back_inserter(text);
  if (unit_meters > 0) fmt::format_to(out, "    metersPerUnit = {}\n", unit_meters);
  text += "    upAxis = \"Y\"\n)\n\ndef BasisCurves \"hair\"\n{\n    int[] curveVertexCounts = [";
  for (size_t s = 0; s < strands.strands(); ++s)
    fmt::format_to(out, "{}{}", s > 0 ? ", " : "", strands.verticesOf(s));
  const bool has_radii = strands.radii.size() == strands.vertices();
  Box extent;
  for (size_t i = 0; i < strands.vertices(); ++i) {
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(has_radii ? strands.radii[i] : 0);
    extent.extend(Eigen::Vector3f(strands.positions[i] - around));
    extent.extend(Eigen::Vector3f(strands.positions[i] + around));
  }
  const auto point = [&](const Eigen::Vector3f& p) {
    fmt::format_to(out, "({}, {}, {})", p.x(), p.y(), p.z());
  };
  text += "]\n    float3[] extent = [";
  point(extent.min());
  text += ", ";
  point(extent.max());
  text += "]\n    point3f[] points = [";
  for (size_t i = 0; i < strands.vertices(); ++i) {
    if (i > 0) text += ", ";
    point(strands.positions[i]);
  }
  text += "]\n    uniform token type = \"linear\"\n    uniform token wrap = \"nonperiodic\"\n";
  if (has_radii) {
    text += "    float[] widths = [";
    for (size_t i = 0; i < strands.radii.size(); ++i)
      fmt::format_to(out, "{}{}", i > 0 ? ", " : "", 2 * strands.radii[i]);
    text += "] (\n        interpolation = \"vertex\"\n    )\n";
  }
  if (!strands.uvs.empty()) {
    text += "    texCoord2f[] primvars:st = [";
    for (size_t i = 0; i < strands.uvs.size(); ++i)
      fmt::format_to(out, "{}({}, {})", i > 0 ? ", " : "", strands.uvs[i].x(), strands.uvs[i].y());
    text += "] (\n        interpolation = \"uniform\"\n    )\n";
  }
  text += "}\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace strandcast
