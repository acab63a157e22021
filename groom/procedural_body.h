#pragma once
#include <cstdint>
#include <vector>

#include "core/contact_primitive.h"
#include "core/geometry.h"

namespace strandcast {

/// A head, neck and shoulders in metres, Y up, facing +Z, with the origin at the centre of the cranium.
/// Modelled as a smooth union of simple shapes and polygonised from that field. Chin to crown 0.23 m,
/// shoulders 0.42 m wide.
struct ProceduralBody {
  TriangleMesh mesh;               ///< watertight, wound outward, with the normals of the field
  std::vector<float> head_weight;  ///< per vertex: 1 moves with the head, 0 is static, smooth across the neck
  uint32_t first_static_triangle = 0;  ///< this triangle and all after it are static: all their weights are 0
  Vec3 neck_pivot = Vec3::Zero();      ///< m, centre of the head's rotation
  std::vector<ContactPrimitive> head;  ///< spheres and capsules inside the skin that move with the head
  std::vector<ContactPrimitive> shoulders;  ///< likewise of neck base and shoulders, which are static
};
/// `cell` is the edge of the polygonisation grid in metres, 0.0015 to 0.01; Error otherwise. Facial detail
/// needs 3 mm or less. The default gives about 105,000 triangles.
ProceduralBody makeProceduralBody(float cell = 0.003f);

/// Signed distance to the skin in metres, negative inside, approximate away from it; and the unit outward
/// normal.
float bodyDistance(const Vec3& point);
Vec3 bodyNormal(const Vec3& point);
/// Density of hair at a point of the skin, 0 (face, neck) to 1 (scalp), smooth at the hairline.
float scalpDensity(const Vec3& point);
/// 1 where a point of the body moves with the head, 0 where it is static, smooth across the neck.
float bodyHeadWeight(const Vec3& point);

}  // namespace strandcast
