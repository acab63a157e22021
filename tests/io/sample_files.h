#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/distance_field.h"
#include "core/strand_set.h"

namespace strandcast::samples {

using Bytes = std::vector<std::byte>;

/// Small valid files, made in memory. Tests damage them, and fuzzers start from them.
Bytes tfx3(bool both_ends_immovable = false);  ///< 3 strands x 4 vertices
Bytes tfx4();                                  ///< 3 strands x 4 vertices, with strand UVs
Bytes hair();                 ///< strands of 2, 3 and 5 points, with thickness, transparency, colours
Bytes hairDefaultSegments();  ///< 2 strands of 4 points each, no array of segments
Bytes objStrands();           ///< 3 strands of 4, 3 and 3 vertices, negative indices, extra columns
Bytes usda();                 ///< curves of 4 and 3 points in a moved Xform, widths, UVs, cubic ones beside
Bytes usdaStage();            ///< variants, indices, comments, hidden and damaged prims: 3 strands
Bytes usdaLabels();           ///< two prims with ids, guide marks, groups and colours: 3 strands
Bytes objMesh();              ///< a cube of quads with a skipped group beside it
Bytes glb();                  ///< two nodes that share a quad of two triangles
Bytes gltf();                 ///< as glb(), in text form with its buffer in a data URI
Bytes sdf();                  ///< 3 x 1 x 2 bricks, two of them stored, about a ball of 5 mm

/// The field in sdf(), and its key.
DistanceField field();
constexpr uint64_t kFieldKey = 0x0123456789ABCDEF;

/// Strand s of the binary samples: `count` vertices, root at (0.05 s, 0.1, 0), growing up and outward.
Vec3 vertex(size_t s, size_t i);

Bytes fromText(const std::string& text);
/// Precondition: a multiple of three bytes.
std::string base64(const Bytes& bytes);

template <class T>
void overwrite(Bytes& bytes, size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

}  // namespace strandcast::samples
