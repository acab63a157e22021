#!/usr/bin/env bash
# Embree 3.13.5: a ray along a straight hair passes through all of its segments, depending on how many there are.
# Package: libembree3-3, libembree-dev 3.13.5 (Debian 12)
# Expected: 1000 rays straight down, within half the radius of a vertical hair of 0.3 m, hit it.
# Seen: round linear curves: 0 hits where the hair has 10 or 30 segments, 1000 where it has 16, 31 or 32. Cone linear curves, which have flat
#   ends: 0 where it has 10, 16 or 32 segments, 1000 where it has 30 or 31. A radius that tapers by a tenth over the hair's length does not
#   help. At a slope of 1 : 1000 nearly all rays hit.
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
have libembree-dev 3.13.5
have libembree3-3 3.13.5
have libtbb12 2021
have libtbbmalloc2 2021
lib=$work/root/usr/lib/$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$lib
cat > try.c <<'C'
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
// Hits of 1000 rays. `tip`: radius at the tip over that at the root; `slope`: of the rays.
static int hits(enum RTCGeometryType type, int segments, float tip, float slope) {
  RTCDevice device = rtcNewDevice(NULL);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry hair = rtcNewGeometry(device, type);
  float *vertex = rtcSetNewGeometryBuffer(hair, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, (size_t)segments + 1);
  unsigned *first = rtcSetNewGeometryBuffer(hair, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, (size_t)segments);
  const float radius = 40e-6f;
  for (int i = 0; i <= segments; ++i) {
    const float along = (float)i / (float)segments;
    vertex[4 * i] = vertex[4 * i + 1] = 0;
    vertex[4 * i + 2] = 0.3f * along;
    vertex[4 * i + 3] = radius * (1 + (tip - 1) * (1 - along));
    if (i < segments) first[i] = (unsigned)i;
  }
  rtcCommitGeometry(hair);
  rtcAttachGeometry(scene, hair);
  rtcCommitScene(scene);
  int hit = 0;
  srand(1);
  for (int i = 0; i < 1000; ++i) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit r = {0};
    r.ray.org_x = radius * ((float)rand() / (float)RAND_MAX - 0.5f) + 0.7f * slope;
    r.ray.org_y = radius * ((float)rand() / (float)RAND_MAX - 0.5f);
    r.ray.org_z = 1;
    r.ray.dir_x = -slope;
    r.ray.dir_z = -1;
    r.ray.tfar = INFINITY;
    r.ray.mask = 0xffffffffu;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &r);
    hit += r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  rtcReleaseGeometry(hair);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return hit;
}
int main(void) {
  int missed = 0, sloped = 1;
  for (int kind = 0; kind < 2; ++kind) {
    const enum RTCGeometryType type = kind == 0 ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE;
    for (int segments = 10; segments <= 32; segments += segments == 10 ? 6 : segments == 16 ? 14 : 1) {
      const int along = hits(type, segments, 1, 0), tapered = hits(type, segments, 0.9f, 0), aside = hits(type, segments, 1, 1e-3f);
      printf("%s, %d segments: %4d hits along the hair, %4d where it tapers, %4d at a slope of 1 : 1000\n", kind == 0 ? "round" : "cone ", segments,
             along, tapered, aside);
      missed |= along == 0 ? 1 << kind : 0;
      sloped &= aside > 990;
    }
  }
  return missed == 3 && sloped ? 0 : 1;
}
C
gcc -I root/usr/include try.c -o try -L "$lib" -l:libembree3.so.3 -lm
./try
