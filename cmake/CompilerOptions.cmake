# Every target of the project links strandcast_options: warnings, sanitizers and the rounding rule; also -pthread and fmt, so
# that all have the flags with which the common headers are precompiled.
add_library(strandcast_options INTERFACE)
target_link_libraries(strandcast_options INTERFACE fmt::fmt)
target_link_options(strandcast_options INTERFACE -pthread)
# Of binutils' two linkers gold takes half the time, for a hundred programs that are linked anew whenever a room changes.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=gold STRANDCAST_HAS_GOLD)
if(STRANDCAST_HAS_GOLD AND NOT STRANDCAST_FUZZ)
  target_link_options(strandcast_options INTERFACE -fuse-ld=gold)
endif()
# With a precompiled header GCC's heap is full from the start, and it would look for garbage again and again: 15 % of its time.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(strandcast_options INTERFACE "SHELL:--param ggc-min-heapsize=800000")  # kB
endif()
target_compile_options(strandcast_options INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic
  $<$<CXX_COMPILER_ID:Clang>:-Wno-overlength-strings>  # shaders are texts as long as they are
  -pthread
  -ffp-contract=off)   # fused multiply-adds are asked for by name (madd), so rounding is a choice
if(STRANDCAST_WERROR)
  # GCC 12 is wrong about inlined strings, and says so once they come from a precompiled header.
  target_compile_options(strandcast_options INTERFACE -Werror
    $<$<CXX_COMPILER_ID:GNU>:-Wno-error=array-bounds -Wno-error=restrict -Wno-error=stringop-overflow>)
endif()
if(STRANDCAST_SANITIZE)
  # A null pointer stops the program without a check; these checks, at every access, took half of the compiler's time, and those of
  # every sum with a pointer, for wrapping around, an eighth of the rest: an access out of bounds is found without. The fuzz preset
  # has them.
  target_compile_options(strandcast_options INTERFACE
    -fsanitize=${STRANDCAST_SANITIZE} -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow -fno-omit-frame-pointer)
  target_link_options(strandcast_options INTERFACE -fsanitize=${STRANDCAST_SANITIZE})
endif()
if(STRANDCAST_FUZZ)
  target_compile_options(strandcast_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)  # a finding ends the run
  target_link_options(strandcast_options INTERFACE -fsanitize=address,undefined)
endif()
