# lancet_library(name folder [DEPENDS targets...]): one of the three library rooms.
# lancet_settings(target): warnings, language and arithmetic that every target of ours shares.

function(lancet_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # Multiply-adds are written where they are meant (fma): the compiler contracts none, so that every scheduler and
  # every build of one instruction set computes the same bits.
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                           -Wno-sign-conversion)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 sees an overlap in std::string's own concatenation (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(LANCET_DEVELOPER)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(LANCET_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${LANCET_SANITIZE} -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${LANCET_SANITIZE})
    # Checks the indices of std::span, std::vector and std::array, which need not leave the memory they lie in.
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
  endif()
endfunction()

function(lancet_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "DEPENDS")
  add_library(lancet_${name} STATIC)
  add_library(lancet::${name} ALIAS lancet_${name})
  set_target_properties(lancet_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  lancet_settings(lancet_${name})
  target_include_directories(lancet_${name} PUBLIC "$<BUILD_INTERFACE:${LANCET_INCLUDE_ROOT}>"
                                                   "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_link_libraries(lancet_${name} PUBLIC ${arg_DEPENDS})
  set_property(GLOBAL APPEND PROPERTY LANCET_LIBRARIES lancet_${name})
endfunction()
