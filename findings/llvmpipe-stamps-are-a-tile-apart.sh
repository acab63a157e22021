#!/usr/bin/env bash
# llvmpipe of Mesa 22.3.6: the GL_TIMESTAMPs around a draw are the time of its last tile apart.
# Package: libgl1-mesa-dri 22.3.6 (Debian 12)
# Expected: GL_TIMESTAMP is written when all commands before it are done (OpenGL 4.5, 4.3): a slow draw's time lies between them.
# Seen: a 64th of it, for a picture of 64 tiles and one thread. Commands between two flushes are done tile by tile, stamps among them, and
#   each tile writes over the stamps of the one before. The rest of the time is found before the first stamp.
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
export LIBGL_ALWAYS_SOFTWARE=1 EGL_PLATFORM=surfaceless LP_NUM_THREADS=1 MESA_SHADER_CACHE_DISABLE=true
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
int main(void) {
  if (!context()) return 77;
  const char *text[2] = {
      "#version 450\nvoid main() { gl_Position = vec4(4.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0); }",
      "#version 450\nout vec4 c; void main() { float s = gl_FragCoord.x;"
      " for (int k = 0; k < 200; ++k) s = fract(s * 1.37 + 0.1); c = vec4(s); }"};
  GLuint draw = glCreateProgram(), target = 0, color = 0, none = 0, stamps[2];
  for (int i = 0; i < 2; ++i) {
    GLuint shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &text[i], NULL);
    glCompileShader(shader);
    glAttachShader(draw, shader);
  }
  glLinkProgram(draw);
  glUseProgram(draw);
  glCreateTextures(GL_TEXTURE_2D, 1, &color);
  glTextureStorage2D(color, 1, GL_RGBA8, 512, 512);
  glCreateFramebuffers(1, &target);
  glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, color, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, 512, 512);
  glCreateVertexArrays(1, &none);
  glBindVertexArray(none);
  glCreateQueries(GL_TIMESTAMP, 2, stamps);
  GLuint64 ns[2];
  struct timespec begin, end;
  for (int again = 0; again < 2; ++again) {  // the first compiles
    glFinish();
    clock_gettime(CLOCK_MONOTONIC, &begin);
    glQueryCounter(stamps[0], GL_TIMESTAMP);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glQueryCounter(stamps[1], GL_TIMESTAMP);
    glFinish();
    clock_gettime(CLOCK_MONOTONIC, &end);
    for (int i = 0; i < 2; ++i) glGetQueryObjectui64v(stamps[i], GL_QUERY_RESULT, &ns[i]);
  }
  double wall = 1e3 * (end.tv_sec - begin.tv_sec) + 1e-6 * (end.tv_nsec - begin.tv_nsec), stamped = 1e-6 * (double)(ns[1] - ns[0]);
  printf("a draw of %.1f ms by the clock: %.1f ms by its stamps\n", wall, stamped);
  return stamped < wall / 8 ? 0 : 1;
}
C
gcc -I root/usr/include try.c -o try -L "$mesa" -l:libepoxy.so.0 -lm
./try
