#!/usr/bin/env bash
# llvmpipe of Mesa 22.3.6: fma() rounds twice, also where its result is precise.
# Package: libgl1-mesa-dri 22.3.6 (Debian 12)
# Expected: one rounding. GLSL 4.50, section 8.3: with a precise result, fma() is a single operation, different from a * b + c.
# Seen: the bits of a * b + c rounded after the product, so that sums of exact products (two-product by fma) do not work.
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
have libepoxy-dev 1.5
have libegl-dev 1.
have libgl1-mesa-dri 22.3.6
have libegl-mesa0 22.3.6
mesa=$work/root/usr/lib/$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$mesa LIBGL_DRIVERS_PATH=$mesa/dri:/usr/lib/$(gcc -print-multiarch)/dri
export LIBGL_ALWAYS_SOFTWARE=1 EGL_PLATFORM=surfaceless MESA_SHADER_CACHE_DISABLE=true
cat > try.c <<'C'
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
// A context of OpenGL 4.5 without a window; 0 where it is not llvmpipe 22.3.6.
static int context(void) {
  EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  if (!eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API)) return 0;
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  EGLContext made = eglCreateContext(display, NULL, EGL_NO_CONTEXT, wanted);
  if (!made || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) return 0;
  printf("%s, %s\n", glGetString(GL_RENDERER), glGetString(GL_VERSION));
  return strncmp((const char *)glGetString(GL_RENDERER), "llvmpipe", 8) == 0 && strstr((const char *)glGetString(GL_VERSION), "22.3.6");
}
// Runs a compute shader of one workgroup; its buffer 0 comes and goes in `data`. 0 where it does not build.
__attribute__((unused)) static int compute(const char *text, void *data, size_t bytes) {
  GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text), buffer = 0;
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  glCreateBuffers(1, &buffer);
  glNamedBufferData(buffer, bytes, data, GL_DYNAMIC_COPY);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer);
  glUseProgram(program);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(buffer, 0, bytes, data);
  return linked;
}
int main(void) {
  if (!context()) return 77;
  float n[8] = {1.0f + 0x1p-12f, 1.0f + 0x1p-12f, -(1.0f + 0x1p-11f), 0};  // the exact product is 1 + 2^-11 + 2^-24
  const char *text = "#version 450\nlayout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer B { float n[8]; };\n"
                     "void main() { precise float once = fma(n[0], n[1], n[2]); n[4] = once; n[5] = fma(n[0], n[1], n[2]); }";
  if (!compute(text, n, sizeof n)) return 1;
  printf("fma gives %g precise and %g else; fused it is %g\n", n[4], n[5], 0x1p-24);
  return n[4] == 0 && n[5] == 0 ? 0 : 1;
}
C
gcc -I root/usr/include try.c -o try -L "$mesa" -l:libepoxy.so.0 -lm
./try
