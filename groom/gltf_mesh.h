#pragma once
#include <span>
#include <string>

#include "core/triangle_mesh.h"
#include "groom/gltf_document.h"
#include "groom/gltf_report.h"
#include "groom/mesh_file.h"
#include "groom/skinned_mesh.h"

namespace strandcast {

/// readGltfMesh() of mesh_file.h that also reads the external buffers of a .gltf.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const ReadBeside& read_beside, const GltfLimits& limits = {});
/// The same of readGltfSkin() of skinned_mesh.h.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const ReadBeside& read_beside, const GltfLimits& limits = {});

/// Reads what a .gltf names out of its own folder, beneath `beneath` where that is not empty.
ReadBeside besideFile(const std::filesystem::path& file, const std::filesystem::path& beneath = {});

/// The mesh of a document with a skin, without normals, where its joints are at rest. Clips are not looked
/// at.
TriangleMesh skinAtRest(const GltfDocument& document, GltfReport& report);

}  // namespace strandcast
