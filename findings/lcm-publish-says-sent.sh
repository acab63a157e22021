#!/usr/bin/env bash
# LCM 1.3.1: lcm_publish() says that a message was sent which cannot arrive.
# Package: liblcm-dev 1.3.1 (Debian 12)
# Expected: an error for 4 MB, of which the receiver's default socket buffer holds a twentieth; its header says "0 on success, -1 on
#   failure".
# Seen: 0 for every size. 40 kB arrive; of 4 MB none of ten does.
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
have liblcm-dev 1.3.1
have liblcm1 1.3.1
lib=root/usr/lib/$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$work/$lib
cat > publish.c <<'C'
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
static int arrived;
static void count(const lcm_recv_buf_t *message, const char *channel, void *user) { ++arrived; }
static int send_ten(lcm_t *from, lcm_t *to, unsigned bytes) {
  void *data = calloc(1, bytes);
  int refused = 0;
  arrived = 0;
  for (int i = 0; i < 10; ++i) {
    refused += lcm_publish(from, "SIZES", data, bytes) != 0;
    while (lcm_handle_timeout(to, 300) > 0) {
    }
  }
  printf("%u bytes, ten times: %d refused, %d arrived\n", bytes, refused, arrived);
  return refused;
}
int main(void) {
  lcm_t *from = lcm_create("udpm://239.255.76.67:7667?ttl=0"), *to = lcm_create("udpm://239.255.76.67:7667?ttl=0");
  if (!from || !to) return 77;
  lcm_subscribe(to, "SIZES", count, NULL);
  send_ten(from, to, 40000);
  if (arrived == 0) return 77;
  return send_ten(from, to, 4000000) == 0 && arrived == 0 ? 0 : 1;
}
C
gcc -I root/usr/include publish.c -o publish -L "$lib" -l:liblcm.so.1
# Multicast on a loopback of its own, so that no other program hears it.
unshare -rn true 2>/dev/null || { echo "skipped: no network namespace"; exit 77; }
unshare -rn sh -c 'ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec ./publish' 2>/dev/null
