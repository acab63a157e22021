#pragma once
#include "io/gltf_document.h"
#include "io/gltf_report.h"

namespace strandcast {

inline constexpr const char* kUncompressed = "export it without mesh compression";

/// Throws Error, which names the extension, when the file requires an unsupported extension that could change
/// the surface. Extensions of materials, textures, lights and metadata do not affect a body and are ignored.
void checkRequiredExtensions(const GltfDocument& document);

/// Reports doubts about the asset. Reports as well each extension that the file uses without requiring it,
/// and that is unsupported and changes the surface, or is unknown. Mesh compression is not reported: the
/// uncompressed fallback is read.
void tellOfAsset(const GltfDocument& document, GltfReport& report);

/// The extension `name` of a node, primitive or other object; null when the object has none of this name.
const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name);

/// Name of the extension that compresses a buffer view, EXT_meshopt_compression or its successor; null if
/// none.
const char* meshoptOf(const nlohmann::json& view);
/// Whether a buffer without data is the fallback of views compressed by meshopt.
bool isMeshoptFallback(const nlohmann::json& buffer);

}  // namespace strandcast
