#!/usr/bin/env bash
# LCM 1.3.1: a subscription's full queue keeps the oldest messages and drops the newest.
# Package: liblcm-dev 1.3.1 (Debian 12)
# Expected: a reader that was late gets the newest state, as of queues of sensors and poses elsewhere.
# Seen: of 100 messages the first 31 are handled (30 is the default capacity); the rest is gone, also the last.
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
cat > queue.c <<'C'
#include <lcm/lcm.h>
#include <stdio.h>
#include <unistd.h>
static int first, last, handled;
static void take(const lcm_recv_buf_t *message, const char *channel, void *user) {
  last = *(const unsigned char *)message->data;
  if (handled++ == 0) first = last;
}
int main(void) {
  lcm_t *from = lcm_create("udpm://239.255.76.67:7667?ttl=0"), *to = lcm_create("udpm://239.255.76.67:7667?ttl=0");
  if (!from || !to) return 77;
  lcm_subscribe(to, "POSE", take, NULL);
  for (unsigned char number = 1; number <= 100; ++number) {
    lcm_publish(from, "POSE", &number, 1);
    usleep(2000);
  }
  usleep(300000);
  while (lcm_handle_timeout(to, 300) > 0) {
  }
  printf("%d handled: %d to %d of 1 to 100\n", handled, first, last);
  if (handled == 0) return 77;
  return handled < 40 && first == 1 && last == handled ? 0 : 1;
}
C
gcc -I root/usr/include queue.c -o queue -L "$lib" -l:liblcm.so.1
# Multicast on a loopback of its own, so that no other program hears it.
unshare -rn true 2>/dev/null || { echo "skipped: no network namespace"; exit 77; }
unshare -rn sh -c 'ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec ./queue' 2>/dev/null
