#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/triangle_mesh.h"
#include "groom/gltf_document.h"
#include "groom/mesh_file.h"
#include "groom/skinned_mesh.h"

namespace strandcast {

/// readGltfMesh() of mesh_file.h that also reads the external buffers of a .gltf out of `folder`.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const std::optional<std::filesystem::path>& folder);
/// The same of readGltfSkin() of skinned_mesh.h.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const std::optional<std::filesystem::path>& folder);

/// The mesh of a document with a skin, without normals, where its joints are at rest. Clips are not looked
/// at.
TriangleMesh skinAtRest(const GltfDocument& document);

}  // namespace strandcast
