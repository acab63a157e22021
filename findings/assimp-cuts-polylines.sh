#!/usr/bin/env bash
# assimp 5.2.5: polylines of an .obj file become loose segments of one mesh.
# Package: libassimp-dev 5.2.5 (Debian 12)
# Expected: two strands of four points each: two meshes, or segments that share their points' indices.
# Seen: one mesh of six faces of two points, and twelve points: each inner point is there twice, under two indices. Which segments are of
#   one line follows from equal positions alone, and where lines cross or touch not even from these.
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
have libassimp-dev 5.2.5
have libassimp5 5.2.5
have libdraco7 1.
have libminizip1 1
lib=root/usr/lib/$(gcc -print-multiarch)
cat > strands.obj <<'O'
v 0 0 0
v 0 1 0
v 0 2 0
v 0 3 0
v 1 0 0
v 1 1 0
v 1 2 0
v 1 3 0
l 1 2 3 4
l 5 6 7 8
O
cat > read.cc <<'C'
#include <cstdio>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
int main() {
  Assimp::Importer importer;
  const aiScene *scene = importer.ReadFile("strands.obj", 0);
  if (!scene) return std::puts(importer.GetErrorString()), 1;
  unsigned points = 0, segments = 0, shared = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh &mesh = *scene->mMeshes[m];
    points += mesh.mNumVertices;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      segments += mesh.mFaces[f].mNumIndices == 2;
      shared += f > 0 && mesh.mFaces[f].mIndices[0] == mesh.mFaces[f - 1].mIndices[1];
    }
  }
  std::printf("%u meshes, %u points (8 in the file), %u segments, %u of which begin at an index where another ends (4 in the file)\n",
              scene->mNumMeshes, points, segments, shared);
  return scene->mNumMeshes == 1 && points == 12 && segments == 6 && shared == 0 ? 0 : 1;
}
C
g++ -w -I root/usr/include read.cc -o read -L "$lib" -l:libassimp.so.5 -Wl,--allow-shlib-undefined
LD_LIBRARY_PATH=$work/$lib ./read
