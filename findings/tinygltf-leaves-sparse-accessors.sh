#!/usr/bin/env bash
# tinygltf 2.7.0: a sparse accessor is read without its substitutes.
# Package: libtinygltf-dev 2.7.0 (Debian 12)
# Expected: a loader hands out what the accessor says: values of the buffer view with those of sparse.values put in.
# Seen: the file loads without error or warning. accessor.sparse is parsed and left to the caller: whoever reads the buffer view, as for
#   any other accessor, has the old values.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# have PACKAGE VERSION: it is installed in this version, or is unpacked below root/.
have() {
  case $(dpkg-query -W -f "\${Version}" "$1" 2>/dev/null) in "$2"*) return ;; esac
  { apt-get download "$1" && deb=$(ls "$1"_*.deb) && dpkg -x "$deb" root; } >/dev/null 2>&1 || deb=
  case $([ -n "$deb" ] && dpkg-deb -f "$deb" Version) in "$2"*) return ;; esac
  echo "skipped: $1 $2 cannot be had"
  exit 77
}
have libtinygltf-dev 2.7.0
have libstb-dev 0.0
have nlohmann-json3-dev 3.
# One accessor of three floats, 1 2 3, whose second is 20: floats 1 2 3, an index (1) in 4 bytes, float 20.
data=$(printf '\0\0\200\77\0\0\0\100\0\0\100\100\1\0\0\0\0\0\240\101' | base64 -w0)
cat > sparse.gltf <<J
{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 20, "uri": "data:application/octet-stream;base64,$data"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 12}, {"buffer": 0, "byteOffset": 12, "byteLength": 4},
                 {"buffer": 0, "byteOffset": 16, "byteLength": 4}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR", "sparse": {"count": 1,
   "indices": {"bufferView": 1, "componentType": 5125}, "values": {"bufferView": 2}}}]}
J
cat > sparse.cc <<'C'
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <cstdio>
#include <cstring>
#include <tiny_gltf.h>
int main() {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  if (!loader.LoadASCIIFromFile(&model, &error, &warning, "sparse.gltf")) return std::puts(error.c_str()), 1;
  const tinygltf::Accessor &accessor = model.accessors[0];
  float value[3];
  std::memcpy(value, model.buffers[0].data.data() + model.bufferViews[accessor.bufferView].byteOffset, sizeof value);
  std::printf("error '%s', warning '%s', isSparse %d: %g %g %g (1 20 3 by the file)\n", error.c_str(), warning.c_str(),
              accessor.sparse.isSparse, value[0], value[1], value[2]);
  return error.empty() && warning.empty() && value[1] == 2 ? 0 : 1;
}
C
g++ -std=c++17 -w -I root/usr/include -I root/usr/include/nlohmann -I /usr/include/nlohmann sparse.cc -o sparse
./sparse
