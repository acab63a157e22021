#pragma once
#include <span>
#include <string>

#include "core/triangle_mesh.h"
#include "io/gltf_document.h"
#include "io/gltf_report.h"
#include "io/mesh_file.h"
#include "io/skinned_mesh.h"

namespace strandcast {

/// As readGltfMesh() in mesh_file.h, and also reads the external buffers of a .gltf.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const ReadBeside& read_beside, const GltfLimits& limits = {});
/// As readGltfSkin() in skinned_mesh.h, and also reads the external buffers of a .gltf.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const ReadBeside& read_beside, const GltfLimits& limits = {});

/// Returns a reader for files that a .gltf names, in the folder of the .gltf. If `beneath` is not empty,
/// reads are confined to it (readBeneath).
ReadBeside besideFile(const std::filesystem::path& file, const std::filesystem::path& beneath = {});

/// The mesh of a document with a skin, with its joints at rest, without normals. Clips are not read.
TriangleMesh skinAtRest(const GltfDocument& document, GltfReport& report);

}  // namespace strandcast
