# LANCET_ISA: the instruction sets that are compiled in. `scalar`, the reference, always is. Which one runs is chosen
# at start-up, and the environment variable LANCET_ISA forces one.

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(lancet_isa_available sse2 avx2 avx512)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  set(lancet_isa_available neon)
else()
  set(lancet_isa_available "")
endif()
set(LANCET_ISA "${lancet_isa_available}" CACHE STRING "Instruction sets to compile in, beside scalar")
foreach(isa IN LISTS LANCET_ISA)
  if(NOT isa IN_LIST lancet_isa_available)
    message(FATAL_ERROR "LANCET_ISA names '${isa}'; this target can have: ${lancet_isa_available}")
  endif()
endforeach()

set(lancet_flags_scalar -fno-tree-vectorize -fno-tree-slp-vectorize)
set(lancet_flags_sse2 -msse2)
set(lancet_flags_avx2 -mavx2 -mfma)
set(lancet_flags_avx512 -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx2 -mfma)
set(lancet_flags_neon "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12's own AVX-512 header reads variables that it leaves uninitialised on purpose.
  list(APPEND lancet_flags_avx512 -Wno-uninitialized -Wno-maybe-uninitialized)
endif()

# Kernels are one deep nest of inlined functions, where checks of every `this`, of every scope of a temporary and of the
# alignment of every load cost the compiler many minutes and gigabytes. Bounds, overflow, shifts and conversions stay
# checked, and so does every access to memory.
if(LANCET_SANITIZE)
  foreach(isa IN LISTS LANCET_ISA ITEMS scalar)
    list(APPEND lancet_flags_${isa} -O1)
    if(LANCET_SANITIZE MATCHES "undefined")
      list(APPEND lancet_flags_${isa} -fno-sanitize=null,object-size,vptr,alignment)
    endif()
    if(LANCET_SANITIZE MATCHES "address")
      list(APPEND lancet_flags_${isa} -fno-sanitize-address-use-after-scope)
    endif()
  endforeach()
endif()
