#pragma once
#include "groom/gltf_document.h"
#include "groom/gltf_report.h"

namespace strandcast {

inline constexpr const char* kUncompressed = "export it without mesh compression";

/// Throws Error, by the extension's name, where the file requires one that is not read and could change the
/// surface. Those of materials, textures, lights and metadata do not matter to a body.
void checkRequiredExtensions(const GltfDocument& document);

/// Passes on what is in doubt about the asset, and says which extensions the file uses, without requiring
/// them, that are not read and change the surface or are not known. Compressed meshes are not among them:
/// what they leave for others to read is read.
void tellOfAsset(const GltfDocument& document, GltfReport& report);

/// An extension of a node, primitive or other object; null where it has none of this name.
const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name);

/// The extension that a buffer view is compressed with, EXT_meshopt_compression or its successor; null if
/// none.
const char* meshoptOf(const nlohmann::json& view);
/// Whether a buffer without data stands for what views compressed by meshopt hold.
bool isMeshoptFallback(const nlohmann::json& buffer);

}  // namespace strandcast
