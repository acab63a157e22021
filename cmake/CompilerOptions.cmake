# Every target of the project links strandcast_options: warnings, sanitizers and the rounding rule. -pthread and fmt are there
# too, because all targets need the flags with which the common headers are precompiled.
add_library(strandcast_options INTERFACE)
target_link_libraries(strandcast_options INTERFACE fmt::fmt)
target_link_options(strandcast_options INTERFACE -pthread)
# gold takes half the time of binutils' other linker. A change to one library relinks up to a hundred programs.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=gold STRANDCAST_HAS_GOLD)
if(STRANDCAST_HAS_GOLD AND NOT STRANDCAST_FUZZ)
  target_link_options(strandcast_options INTERFACE -fuse-ld=gold)
endif()
# A precompiled header fills GCC's heap from the start; with the default minimum heap size, garbage collection takes 15 % of
# the compile time.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(strandcast_options INTERFACE "SHELL:--param ggc-min-heapsize=800000")  # kB
endif()
target_compile_options(strandcast_options INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic
  $<$<CXX_COMPILER_ID:Clang>:-Wno-overlength-strings>  # embedded shaders are long string literals
  -pthread
  -ffp-contract=off)   # rounding rule: only madd() may fuse a multiply-add
if(STRANDCAST_WERROR)
  # GCC 12 gives false warnings about inlined strings from a precompiled header.
  target_compile_options(strandcast_options INTERFACE -Werror
    $<$<CXX_COMPILER_ID:GNU>:-Wno-error=array-bounds -Wno-error=restrict -Wno-error=stringop-overflow>)
endif()
if(STRANDCAST_SANITIZE)
  # Off: null, alignment, object-size and vptr checks at every access took half of the compile time, and a null pointer stops the
  # program anyway. pointer-overflow took an eighth of the rest, and AddressSanitizer finds accesses out of bounds without it.
  # The fuzz preset has all of them.
  target_compile_options(strandcast_options INTERFACE
    -fsanitize=${STRANDCAST_SANITIZE} -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow -fno-omit-frame-pointer)
  target_link_options(strandcast_options INTERFACE -fsanitize=${STRANDCAST_SANITIZE})
endif()
if(STRANDCAST_FUZZ)
  target_compile_options(strandcast_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)  # a finding ends the run
  target_link_options(strandcast_options INTERFACE -fsanitize=address,undefined)
endif()
